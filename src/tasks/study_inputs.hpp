#pragma once
/// What varies, from texts.

#include "hydrapod/tasks/study.hpp"

namespace hydrapod::tasks {

/// The number or, for `poses`, the direction of `varied`, with the values of a grid or the ends of
/// a range ("from:to"). Throws base::InputError.
study::Input input_over(const Machine& machine, const Varied& varied, bool poses, bool grid);

/// Everything that varies.
struct StudyInputs {
  std::vector<study::Input> inputs{};
  std::size_t outer{};            ///< of them make rows; each row is the worst over the others
  Eigen::MatrixXd correlation{};  ///< see study::Problem
};

/// Throws base::InputError with all mistakes.
StudyInputs study_inputs(const Machine& machine, const StudyOptions& options);

/// Names of the extra outputs that are asked for or required; "stiffness" stands for all six.
/// Throws base::InputError for one that the machine does not have.
std::vector<std::string> extra_outputs_of(const Machine& machine, const StudyOptions& options);

/// Those of `columns` that StudyOptions::only and `want` name; none: all are asked for. Throws
/// base::InputError for an unknown one, and for one that the machine does not have.
std::optional<std::vector<std::string>> only_of(const Machine& machine, const StudyOptions& options,
                                                const std::vector<study::Column>& columns);

/// The number at a path. Throws base::InputError with the path that was probably meant.
model::FileNumber number_at(const Machine& machine, const std::string& path,
                            const std::string& place);

/// What is wrong with numbers of a pose that is none of `poses`: they would have no effect.
std::vector<base::Diagnostic> of_other_poses(const Machine& machine,
                                             const std::vector<study::Input>& inputs,
                                             const std::vector<model::NamedPose>& poses);

/// Why this machine does not have an output that others have, and what it has; none: it is no such
/// output.
std::optional<std::string> no_output_text(const model::Machine& machine, dynamics::ModelKind kind,
                                          const std::vector<study::Column>& outputs,
                                          std::string_view name);
/// Throws base::InputError with that.
void require_output(const model::Machine& machine, dynamics::ModelKind kind,
                    const std::vector<study::Column>& outputs, std::string_view name,
                    const std::string& place);
/// The same of a text "x >= 6 Hz", with that read.
study::Requirement requirement_of(const model::Machine& machine, dynamics::ModelKind kind,
                                  std::vector<study::Column> outputs, const std::string& text);

/// "3 min", "2.5 h".
std::string duration_text(double seconds);

}  // namespace hydrapod::tasks
