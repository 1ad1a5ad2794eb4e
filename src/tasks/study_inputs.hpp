#pragma once
/// What varies, from texts.

#include "hydrapod/tasks/study.hpp"

namespace hydrapod::tasks {

/// The number or, for `poses`, the direction of `varied`, with the values of a grid or the ends of
/// a range ("from:to"). Throws base::InputError.
study::Input input_over(const Machine& machine, const Varied& varied, bool poses, bool grid);

/// The number at a path. Throws base::InputError with the path that was probably meant.
model::FileNumber number_at(const Machine& machine, const std::string& path,
                            const std::string& place);

/// What is wrong with numbers of a pose that is none of `poses`: they would have no effect.
std::vector<base::Diagnostic> of_other_poses(const Machine& machine,
                                             const std::vector<study::Input>& inputs,
                                             const std::vector<model::NamedPose>& poses);

/// "3 min", "2.5 h".
std::string duration_text(double seconds);

}  // namespace hydrapod::tasks
