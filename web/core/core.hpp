#pragma once
/// The core of the page that calculates: the library's own kinematics, statics, modes and responses
/// behind a few functions over JSON. page_core.cpp hands them to the browser. The tests of the page
/// (tests/web/what_if.test.mjs) compare the results with those of the command line.
///
/// A machine comes as report's editable_json() wrote it. Every request names the numbers that
/// differ from it by their paths, so that the core has no state but the machine it was opened with
/// and the last model, whose responses may be asked for. Results are those of the command line with
/// the same
/// `--set`: the same functions compute and write them.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/response/frequency_response.hpp"
#include "response/direct_responses.hpp"

namespace hydrapod::page {

using report::Json;

/// The machine of report's editable_json(), bit by bit. What has no numbers (names, texts) stays
/// empty, except names of poses.
model::Machine machine_of(const Json& editable);

class Core {
 public:
  /// Throws std::exception for what editable_json() did not write.
  explicit Core(const Json& editable);

  /// Every number that may be changed: path, unit, value, bounds, meaning, whether it enters the
  /// linear models, whether it is of a single leg, and of an array: path of the array and
  /// what follows it.
  [[nodiscard]] Json parameters() const;

  /// `{ "set": [[path, value], …], "pose": number, "points": of a Bode curve, 0: none }`.
  /// What editable_json() calls `shown` counts the poses; instead of one, `"displaced": [x, …, rz]`
  /// is a displacement from the neutral pose [m, rad], as of `--pose`. The answer has `findings`,
  /// those of the changed machine, and, where none of them is an error, `pose`: as report_json()
  /// has it; or `problem`, why there are no modes. With `"brief": true` instead of `points`, `pose`
  /// is that of brief_pose_report(), and sweep() gives direct responses.
  Json compute(const Json& request);

  /// Responses of the machine of the last compute() to a wrench at the platform's mass centre,
  /// flexible then rigid legs, each by line, output and input: re, im; direct responses by line and
  /// direction. Nothing without modes.
  std::vector<double> sweep(const std::vector<double>& omega) const;

  /// `{ "set", "pose" or "displaced", "from", "to", "points" }`: see bode_curves(). Throws
  /// base::ComputationError where there are no modes.
  [[nodiscard]] std::vector<double> curves(const Json& request) const;

  /// `{ "set", "pose" }`: payload at which the legs buckle, or why it is not known.
  [[nodiscard]] Json buckling(const Json& request) const;

  /// `{ "pose" }`: relative change of the lowest frequency with platform motion per relative change
  /// of each number of the linear models, by path; central differences.
  [[nodiscard]] Json sensitivities(const Json& request) const;

  /// `{ "set" }`, and displacements from the neutral pose, six numbers each: status as of
  /// study::Status, lowest [Hz], its direction 1 … 6, drop, first resonances x … rz [Hz] and their
  /// drops, stroke left [m], share and peak of the lowest mode, shares and peaks of the first
  /// resonances: map_columns numbers each, NaN where there are none, as `hydrapod map`.
  [[nodiscard]] std::vector<double> map(const Json& request,
                                        const std::vector<double>& displacements) const;
  static constexpr int map_columns = 31;

  /// `{ "set", "pose" or "displaced", "vary": [[path, deviation as a share, per leg], …], "seed",
  /// "from", "count" }`: rows of map() of the samples `from` … of `hydrapod montecarlo` with normal
  /// distributions about the values that the machine has.
  [[nodiscard]] std::vector<double> scatter(const Json& request) const;

  /// `{ "set" }`: per direction [least, largest] displacement from the neutral pose that is within
  /// reach on the way from there [m, rad], at most a third of a leg or 45°.
  [[nodiscard]] Json reach(const Json& request) const;

 private:
  struct Shown {
    std::string name{};
    std::optional<std::size_t> of{};  ///< pose of the machine
    spatial::Pose X{};                ///< else: displacement from the neutral pose
  };
  struct Swept {
    response::ResponseModel model{};
    response::DampedShapes damped{};  ///< where the direct responses alone are asked for
  };

  [[nodiscard]] model::Machine changed(const Json& set) const;
  [[nodiscard]] model::ParameterId parameter(const std::string& path) const;
  [[nodiscard]] model::NamedPose pose(const model::Machine& machine, const Json& request) const;

  model::Machine machine_{};
  dynamics::ModelKind kind_{};
  std::vector<Shown> shown_{};
  std::vector<std::pair<std::string, model::ParameterId>> parameters_{};
  std::vector<Swept> swept_{};  ///< flexible and rigid legs
  bool direct_{};               ///< the direct responses alone are asked for
};

}  // namespace hydrapod::page
