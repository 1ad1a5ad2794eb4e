#pragma once
/// Hypotheses fitted to what was measured. Private to the module.

#include <optional>

#include "hydrapod/base/error.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis {

/// All causes of a machine.
std::vector<Cause> causes_of(const model::MachineFile& file);

/// Can both be the cause at once, and are they worth being tried together?
bool can_be_together(const Cause& a, const Cause& b);

/// Why no machine with modes, or no plant, has the numbers that `task` meets; none: it is done.
template <class Task>
std::optional<std::string> why_impossible(const Task& task) {
  try {
    task();
    return std::nullopt;
  } catch (const base::ComputationError& error) {
    return error.what();
  } catch (const base::InputError& error) {
    const auto& first = error.diagnostics().front();
    return first.key.empty() ? first.message : first.key + " " + first.message;
  }
}

template <class Task>
bool if_possible(const Task& task) {
  return !why_impossible(task);
}

/// The measured modes with the deviations that count, what they have in common, and directions
/// where shapes tell them.
observation::Targets weighted_targets(const model::MachineFile& file,
                                      const observation::Targets& measured,
                                      const DiagnoseOptions& options);

/// Number of measured values.
int values_in(const observation::Targets& targets);

/// Do the targets ask for more than undamped modes of mechanics: those of the plant or the system,
/// or responses?
bool beyond_mechanics(const observation::Targets& targets);

/// Fits hypotheses. Where the targets ask for more than modes of mechanics, each is sought with
/// these (fast, from many starts), to which frequencies measured of the plant or the system are
/// brought by the ratio of mechanics to it of the nominal machine, and then fitted to everything
/// from there.
class Evidence {
 public:
  /// All of these must outlive it. Throws base::ComputationError where the nominal machine has no
  /// modes.
  Evidence(const model::MachineFile& file, const observation::Targets& targets,
           dynamics::ModelKind kind, const std::vector<Cause>& causes);

  /// The nominal machine.
  [[nodiscard]] const Hypothesis& nominal() const { return stated_; }
  /// With legs, gimbals and base that are rigid.
  [[nodiscard]] Hypothesis rigid() const;
  /// The numbers of these causes let free, by mechanics. `known`: a hypothesis by one of them,
  /// whose values it begins with. Throws base::ComputationError where no such machine has modes.
  [[nodiscard]] Hypothesis explain(const std::vector<std::size_t>& causes, const Hypothesis* known,
                                   const numerics::Progress& stop) const;
  /// Compares it as it is with everything that was measured.
  void see(Hypothesis& hypothesis) const;
  /// Fits it to everything that was measured. `and_stated`: from the stated values too.
  void polish(Hypothesis& hypothesis, bool and_stated, const numerics::Progress& stop) const;
  /// Goes on from what others found for its causes, where these numbers meet everything that was
  /// measured better than its own: `found[k]`, hypotheses that hold cause k, best first.
  void learn(Hypothesis& hypothesis, const std::vector<std::vector<const Hypothesis*>>& found,
             const numerics::Progress& stop) const;
  /// Tries softer and softer seals that have dampers, and goes on from the best where that meets
  /// everything that was measured better than its own. Modes of mechanics, which are undamped, do
  /// not lead to seals that are so soft that their dampers hold the rod.
  void scan_seals(Hypothesis& hypothesis, const numerics::Progress& stop) const;
  /// Adds to the deviations of its parameters what a model error that all frequencies share makes
  /// of them, where the fit counts the errors of modes as independent.
  void widen(Hypothesis& hypothesis, double frequency_error) const;
  /// One cause fitted to the modes that mainly move in `direction`, and how it then meets the
  /// others.
  struct Part {
    Hypothesis hypothesis{};
    observation::Targets rest{};
    calibration::Candidate at_rest{};
  };
  [[nodiscard]] std::optional<Part> explain_direction(std::size_t cause, int direction,
                                                      const numerics::Progress& stop) const;

  [[nodiscard]] bool in_two_steps() const { return beyond_mechanics(targets_); }
  [[nodiscard]] const model::MachineFile& file() const { return file_; }
  [[nodiscard]] const observation::Targets& targets() const { return targets_; }
  [[nodiscard]] const std::vector<Cause>& causes() const { return causes_; }

 private:
  [[nodiscard]] bool has_damped_seals(const Cause& cause) const;
  [[nodiscard]] dynamics::ModelKind kind_with(const std::vector<std::size_t>& causes) const;
  [[nodiscard]] int starts_for(const std::vector<std::size_t>& causes, bool known) const;
  [[nodiscard]] model::MachineFile file_with(const Hypothesis& hypothesis) const;
  [[nodiscard]] Hypothesis search(const std::vector<std::size_t>& causes,
                                  const observation::Targets& targets, const Hypothesis* known,
                                  const numerics::Progress& stop) const;
  /// As it is, compared with everything that was measured; none where that cannot be had.
  [[nodiscard]] std::optional<calibration::Candidate> seen(const Hypothesis& hypothesis) const;
  /// Fitted again from its own values, or those of the file.
  [[nodiscard]] calibration::Candidate refit(const Hypothesis& hypothesis,
                                             const observation::Targets& targets, bool from_stated,
                                             const numerics::Progress& stop) const;
  /// None where no machine, or no plant, has the numbers that it finds.
  [[nodiscard]] std::optional<calibration::Candidate> sound_refit(
      const Hypothesis& hypothesis, const observation::Targets& targets, bool from_stated,
      const numerics::Progress& stop) const;
  void polish(Hypothesis& hypothesis, const observation::Targets& targets, bool and_stated,
              const numerics::Progress& stop) const;
  [[nodiscard]] observation::Targets for_mechanics() const;

  const model::MachineFile& file_;
  const observation::Targets& targets_;
  dynamics::ModelKind kind_;
  const std::vector<Cause>& causes_;
  Hypothesis stated_{};
  observation::Targets by_mechanics_{};  ///< the modes brought to mechanics
};

/// Have two hypotheses the same numbers, nearly, for what both let free?
bool same_numbers(const Hypothesis& a, const Hypothesis& b);

/// Why the nominal machine cannot be compared with the targets, as in Substitution; none: it can.
std::optional<std::string> plant_refused(const model::MachineFile& file,
                                         const observation::Targets& targets,
                                         dynamics::ModelKind kind);

/// Resonances that are missing, and measured values that it misses, worst first; at most three.
std::vector<Contradiction> what_is_wrong(const Evidence& evidence, const Hypothesis& hypothesis);

/// Fitted to the direction that the nominal machine misses most, what does a cause with one
/// number do to the others? None when it does no harm.
std::optional<Contradiction> contrary(const Evidence& evidence, const Hypothesis& nominal,
                                      const Hypothesis& hypothesis, const numerics::Progress& stop);

/// Why the data cannot be this machine's, or cannot say anything about it; empty: they may be.
std::vector<Objection> objections(const Evidence& evidence, const Hypothesis& nominal);

}  // namespace hydrapod::diagnosis
