#pragma once
/// What a command may write over. Checked before the command begins.
///
/// - No output is an input of the same command, whatever its name: the files are compared, not the
///   names (links, "./", hard links).
/// - No two outputs are the same file.
/// - A record, a machine file or a study that exists is replaced only with --force. So is a text
///   (table, JSON, page, notes) that hydrapod did not write. What it wrote says so: JSON by its
///   fields, CSV by its titles, a table by its last line. Pictures are replaced.
/// - There must be a folder that can be written to.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::cli {

/// Of an output that exists already.
enum class Existing {
  judged,  ///< by its contents, as above
  kept     ///< whatever it is, it is replaced with --force only
};

/// A file name that an option was given.
struct NamedFile {
  std::string option{};  ///< "-o"
  std::string path{};
  Existing existing{};
};

/// The file that the text of an input names: `run.h5`, `run.h5@low`, `file run.csv, hold=1`. None
/// where there is no such file.
std::optional<std::string> input_file(const std::string& text);

/// Throws base::InputError with all that is wrong. `inputs` may be no files at all (a pose, a
/// signal): then they are passed over.
void check_outputs(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs,
                   bool force);

/// Which of `words` ("table" first, "json", "csv", "uff", "mat", …) is written to `output`: that of
/// --format, or where `format` is empty that of the ending. Throws base::InputError for another
/// word, for an ending of other contents (.h5 for a table), and for a binary format without a file
/// name.
std::size_t result_format(const std::string& format, const std::string& output,
                          const std::vector<std::string_view>& words);

/// Throws base::InputError where `output` ends as files with other contents than `accepted`
/// (".html") do. Endings that nobody knows are accepted.
void require_ending(const std::string& option, const std::string& output,
                    std::string_view accepted);

/// Writes a file whole, see base::write_file_whole, and says so unless it was printed.
void write_output(const std::string& path, const std::string& text);

/// The same of a result in the format that result_format() chose. A table (0) in a file ends with
/// the command and the checksums of what was read, and with the line "written by hydrapod …", by
/// which a later run knows that it may replace it.
void write_result(const std::string& path, std::size_t format, const std::string& text);

}  // namespace hydrapod::cli
