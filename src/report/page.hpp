#pragma once
/// The page as web/ builds it.

#include <string_view>

namespace hydrapod::report {

/// The bundled page with its placeholders; empty when this program was built without it.
std::string_view page_template();

/// Why page_template() is empty.
std::string_view why_no_page();

}  // namespace hydrapod::report
