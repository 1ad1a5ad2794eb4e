/// By which command a picture was drawn, in the picture: SVG has a description, PNG a text chunk,
/// PDF a comment behind its end.

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "gnuplot.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

std::function<std::string()>& origin_of_pictures() {
  static std::function<std::string()> origin;
  return origin;
}

/// Valid UTF-8 without control characters, line by line.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(base::printable(line, line.size()));
  return lines;
}

/// Of an element, where quotes stay: a command can be copied from the file (escape_html takes
/// them).
std::string xml_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

/// What stands between `begin` and `end`, which it has, replaced.
bool replace_element(std::string& text, std::string_view begin, std::string_view end,
                     const std::string& by) {
  const auto from = text.find(begin);
  const auto to = from == std::string::npos ? from : text.find(end, from);
  if (to == std::string::npos) return false;
  text.replace(from, to + end.size() - from, by);
  return true;
}

/// gnuplot's title, which browsers show beside the pointer, goes.
void describe_svg(std::string& svg, const std::string& note) {
  replace_element(svg, "<title>", "</title>\n", "");
  replace_element(svg, "<desc>", "</desc>", "<desc>" + xml_text(note) + "</desc>");
}

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes += static_cast<char>((number >> static_cast<unsigned>(shift)) & 0xFFU);
  return bytes;
}

/// A chunk iTXt (UTF-8, not compressed) behind the first chunk, which is IHDR.
void describe_png(std::string& png, const std::string& note) {
  constexpr std::size_t behind_header = 8 + 25;  // signature; length, name, 13 bytes, checksum
  if (png.size() < behind_header) return;
  using std::string_literals::operator""s;
  const std::string chunk = "iTXtDescription\0\0\0\0\0"s + note;
  const auto sum =
      ::crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size()));
  png.insert(behind_header, big_endian(static_cast<std::uint32_t>(chunk.size() - 4)) + chunk +
                                big_endian(static_cast<std::uint32_t>(sum)));
}

/// Readers look for the place of the table and the mark %%EOF in the last kilobyte.
void describe_pdf(std::string& pdf, const std::vector<std::string>& lines) {
  const auto ending = pdf.rfind("startxref");
  if (ending == std::string::npos) return;
  const std::string last = pdf.substr(ending);
  if (pdf.back() != '\n') pdf += '\n';
  for (const auto& line : lines) pdf += "% " + line + '\n';
  pdf += last;
}

}  // namespace

void state_in_pictures(std::function<std::string()> origin) {
  origin_of_pictures() = std::move(origin);
}

std::string with_origin(std::string picture, std::string_view path) {
  const auto& origin = origin_of_pictures();
  if (!origin) return picture;
  const auto lines = lines_of(origin());
  const std::string note = fmt::format("{}", fmt::join(lines, "\n"));
  if (path.ends_with(".svg"))
    describe_svg(picture, note);
  else if (path.ends_with(".png"))
    describe_png(picture, note);
  else
    describe_pdf(picture, lines);
  return picture;
}

}  // namespace hydrapod::report
