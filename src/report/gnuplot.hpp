#pragma once
/// Running gnuplot. Private to the module.

#include <functional>
#include <string>

namespace hydrapod::report {

/// `text` as a gnuplot string; line ends in it, which would end the command, become blanks.
std::string quoted(const std::string& text);

/// Makes the script for a gnuplot terminal and an output file.
using Script = std::function<std::string(const std::string& terminal, const std::string& file)>;

/// Draws a picture of `width` × `height` pixels; its format follows from the ending of `path`
/// (.svg, .png, .pdf). The file is written whole or not at all. Throws base::InputError for another
/// ending or a folder that is not there, base::ComputationError when gnuplot is missing or fails.
void draw(const std::string& path, int width, int height, const Script& script);

}  // namespace hydrapod::report
