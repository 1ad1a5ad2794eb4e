#pragma once
/// Explanations fitted to what was measured. Private to the module.

#include <functional>

#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis {

/// The measured modes with the deviations that count, and directions where shapes tell them.
calibration::Targets weighted_targets(const model::MachineFile& file,
                                      const calibration::Targets& measured,
                                      const DiagnoseOptions& options);

/// Number of measured values.
int values_in(const calibration::Targets& targets);

class Evidence {
 public:
  /// All of these must outlive it.
  Evidence(const model::MachineFile& file, const calibration::Targets& targets,
           dynamics::ModelKind kind, const std::vector<Suspect>& suspects)
      : file_(file), targets_(targets), kind_(kind), suspects_(suspects) {}

  /// The machine as stated.
  [[nodiscard]] Explanation as_stated() const;
  /// With legs, gimbals and base that do not give way.
  [[nodiscard]] Explanation rigid() const;
  /// `blamed` let free. `known`: an explanation by one of them, whose values it begins with. Throws
  /// base::ComputationError where no such machine has modes.
  [[nodiscard]] Explanation explain(const std::vector<std::size_t>& blamed,
                                    const Explanation* known,
                                    const calibration::Progress& stop) const;
  /// The same with only some of the measured modes.
  /// Adds to the deviations of its parameters what a model error that all frequencies share makes
  /// of them: the fit counts the errors of modes as independent.
  void widen(Explanation& explanation, double frequency_error) const;
  [[nodiscard]] Explanation explain_some(std::size_t blamed, const calibration::Targets& some,
                                         const calibration::Progress& stop) const;

  [[nodiscard]] const model::MachineFile& file() const { return file_; }
  [[nodiscard]] const calibration::Targets& targets() const { return targets_; }
  [[nodiscard]] const std::vector<Suspect>& suspects() const { return suspects_; }

 private:
  [[nodiscard]] dynamics::ModelKind kind_with(const std::vector<std::size_t>& blamed) const;
  [[nodiscard]] int starts_for(const std::vector<std::size_t>& blamed, bool known) const;
  [[nodiscard]] Explanation fitted(const std::vector<std::size_t>& blamed,
                                   const calibration::Targets& targets, const Explanation* known,
                                   const calibration::Progress& stop) const;

  const model::MachineFile& file_;
  const calibration::Targets& targets_;
  dynamics::ModelKind kind_;
  const std::vector<Suspect>& suspects_;
};

/// Calls task(i) for i in [0, count) on several threads. `stop` is asked between tasks. Rethrows
/// the first exception of a task.
void for_all(std::size_t count, int threads, const std::function<void(std::size_t)>& task,
             const std::function<bool(double)>& stop);

}  // namespace hydrapod::diagnosis
