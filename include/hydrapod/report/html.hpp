#pragma once
/// The report as one self-contained HTML file: the bundled page (web/, put into the library at
/// build time) and one JSON document that it draws.
///
/// Nothing in the machine file can become markup: the JSON is escaped so that it holds neither `<`,
/// `>`, `&` nor line separators of JavaScript, and the page only ever writes text nodes. A content
/// security policy allows nothing but the page's own script and style.

#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

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
