#pragma once
/// The JSON that the command line writes and the web pages read. Field names are documented in
/// docs/howto/json.md and stable: new fields may come, none changes its meaning.
///
/// A reader stands beside its writer. It throws base::InputError with file and key; `file` is what
/// messages call the JSON.
///
/// The answer to the user's question in words and in four numbers: the lowest frequency, the same
/// with rigid legs, the drop, and where the energy of that mode is.
///
/// The report as one self-contained HTML file: the bundled page (web/, put into the library at
/// build time) and one JSON document that it draws.
///
/// Nothing in the machine file can become markup: the JSON is escaped so that it holds neither `<`,
/// `>`, `&` nor line separators of JavaScript, and the page only ever writes text nodes. A content
/// security policy allows nothing but the page's own script and style.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::report {

using Json = nlohmann::ordered_json;

/// A machine as a result is of it.
struct Subject {
  model::MachineFile file{};
  std::string path{};  ///< of the file, as messages and JSON call it
  model::NamedPose pose{};
  dynamics::ModelKind kind{};
};

/// What a result was computed from: name, source, file, overrides.
Json machine_json(const model::MachineFile& file, const std::string& path);

Json pose_json(const model::NamedPose& pose);
/// `pose` of a result.
model::NamedPose pose_from_json(const Json& json, const std::string& file);

/// Gravity, axes, damping: everything a reader must know to reproduce the numbers.
Json assumptions_json(const model::Machine& machine);

/// How a result's JSON begins: `kind`, `machine`, `assumptions`, and for a result at one pose
/// `pose`.
Json head_json(const char* kind, const model::MachineFile& file, const std::string& path);
Json head_json(const char* kind, const Subject& subject);

/// `modes[]`, `rigid_modes[]`, `coordinates[]`.
Json modes_json(const modal::ModeTable& table);
/// Reads it. Models (`linear`, `normal`) stay empty.
modal::ModeTable modes_from_json(const Json& json, const std::string& file);

/// `matrices`: M, K, C of the model asked for and of the rigid one, row by row.
Json matrices_json(const modal::ModeTable& table);

/// "2 % of critical in every mode (default, the machine file gives no damping)".
std::string damping_text(const model::Machine& machine);

/// What damps where the oil is hydraulics and no spring: in simulations and in poles of the system.
/// "oil by leakage, valves and friction; seals by their dampers + 1 % of critical". Without
/// `hydraulics`: of the nonlinear mechanics on oil springs, "oil springs by their dampers; seals
/// …"; of struts always that.
std::string plant_damping_text(const model::Machine& machine, bool hydraulics = true);

/// "gravity 9.81 m/s² downwards", "no gravity".
std::string gravity_text(const model::Machine& machine);

/// Which machine the results are of: "nominal", "calibrated, with platform.mass=4 t"; of struts
/// also which model they have.
std::string state_text(const model::MachineFile& file);
/// The same of results of mechanics alone: with electric cylinders their motors are locked.
std::string mechanics_state_text(const model::MachineFile& file);

/// A share without its % sign: "82"; "<1" for less than half a per cent.
std::string percent_text(double share);

/// "oil 82 %, sleeves 18 %": springs that hold at least half a per cent of the elastic energy;
/// `leg`: whose axes `oil` is of.
std::string energy_text(double oil, double guide_sleeve, double piston_ring, double base,
                        double payload = 0.0, double bending = 0.0, model::LegType leg = {});
std::string energy_text(const modal::EnergyShares& energy);

/// What the share of oil, struts or screws holds beside them: gimbals in series, sticking seals in
/// parallel. A line with its end; empty where there are neither.
std::string axial_energy_text(const model::Machine& machine);

/// "Lowest mode the platform feels: 7.45 Hz in x; …", one line with its end; empty when there is no
/// such mode.
std::string answer_text(const modal::ModeTable& table);

/// `text`, `stable`, `mode`, `frequency_hz`, `directions`, `strain_energy`, and for models with
/// flexible legs `rigid_mode`, `rigid_frequency_hz`, `drop_percent`; null when the platform feels
/// no mode.
Json answer_json(const modal::ModeTable& table);

enum class Theme { automatic, light, dark };

struct HtmlOptions {
  std::string title{};            ///< empty: the machine's name
  Theme theme{Theme::automatic};  ///< automatic: as the reader's system is set
  std::vector<int> modes{};  ///< modes pictured in print, from 1; empty: those the platform feels,
                             ///< at most six. The first one is shown when the page opens.
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  int points{600};  ///< of a Bode curve, ≥ 2, before those added around resonances
};

/// The document that the page draws. Its sections are there when their data are: `poses[]` holds
/// modes, geometry, bode and answer per pose. Throws std::invalid_argument without poses, for
/// `points` < 2 and for modes that the model does not have.
Json report_json(const model::MachineFile& file, const std::string& path,
                 const std::vector<model::NamedPose>& poses, const HtmlOptions& options = {});

/// The page around `document` (an object with `title`). Throws base::ComputationError when the page
/// was not built into this program.
std::string html_page(const Json& document, Theme theme = Theme::automatic);

/// report_json and html_page in one.
std::string html_report(const model::MachineFile& file, const std::string& path,
                        const std::vector<model::NamedPose>& poses,
                        const HtmlOptions& options = {});

/// `text` as HTML text or attribute value.
std::string escape_html(std::string_view text);

/// JSON that may stand inside a <script> element: `<`, `>`, `&`, U+2028 and U+2029 as \uXXXX,
/// broken UTF-8 replaced by U+FFFD.
std::string escape_json(const Json& json);

}  // namespace hydrapod::report
