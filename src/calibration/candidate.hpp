#pragma once
/// One combination of choices: its problem, its starts, what became of them. Private to the module.

#include "hydrapod/calibration/calibrate.hpp"
#include "problem.hpp"
#include "solver.hpp"

namespace hydrapod::calibration {

/// A combination with everything that its fits need; stays where it is, for fits refer to it.
struct Combination {
  Candidate candidate{};
  std::unique_ptr<Problem> problem{};
  std::vector<Solution> solutions{};  ///< per start
};

/// The file with the choices of the candidate made; only these need its text.
model::MachineFile file_with_choices(const model::MachineFile& file, const Candidate& candidate);

/// Start number `number` of a problem: the given one, then random ones within the bounds and a
/// factor of five.
Eigen::VectorXd start_of(const Problem& problem, std::uint64_t seed, int number);

/// Fills in the candidate from the best of its solutions.
void conclude(Combination& combination);

/// Are its targets off by several deviations on the whole?
bool fits_poorly(const Candidate& candidate);

/// The same with a loss that hardly feels targets that lie far off, where that shows a few wrong
/// ones and meets all others; true if it does, and the candidate is then that fit. `force`: take it
/// in any case.
bool conclude_robust(Combination& combination, const FitOptions& options, bool force,
                     const std::function<bool()>& stop);

/// The candidate's best fit if nothing had to be admissible.
void conclude_unbound(Combination& combination, const FitOptions& options,
                      const std::function<bool()>& stop);

}  // namespace hydrapod::calibration
