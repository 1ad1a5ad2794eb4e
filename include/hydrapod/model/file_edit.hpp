#pragma once
/// A machine file's text with some values changed and everything else, comments included, as it
/// was.

#include <string>
#include <vector>

namespace hydrapod::model {

/// A value to put at `path`, as TOML ("7.2", "\"7.2 kg\"", "[0, 0, 1]").
struct FileEdit {
  std::string path{};
  std::string value{};
  std::string remark{};  ///< goes to the comment at the end of the line; may be empty
  bool taken_out{};      ///< its lines become comments instead; `value` is of no use
};

/// What laying `overrides` (PATH=VALUE) over the file changes in it, value by value: a table that
/// an override gives is compared key by key, and what it or the other way of saying the same thing
/// (a cylinder instead of a stiffness) leaves out is taken out. Throws base::ComputationError for
/// overrides that cannot be laid over this file.
std::vector<FileEdit> edits_of_overrides(const std::string& text,
                                         const std::vector<std::string>& overrides);

/// `text` with the edits made, one after the other. A path that is not there is added to its
/// table, and one that is taken out stays as a comment where it has lines of its own. Remarks of
/// one line are joined after "`label`: "; such a comment of an earlier run is replaced. Throws
/// base::ComputationError when the place of a path cannot be edited (a whole table).
std::string edited_file(const std::string& text, const std::vector<FileEdit>& edits,
                        const std::string& label);

/// The unit written at `path` with its size in SI ("mm", 1e-3); empty with 1 where a plain number
/// or nothing stands.
struct WrittenUnit {
  std::string name{};
  double size{1.0};
};
WrittenUnit written_unit(const std::string& text, const std::string& path, const std::string& si);

/// `value` [SI] as TOML in that unit: `"35.2 kg"`, or a plain number. `digits`: significant ones.
std::string written(double value, const WrittenUnit& unit, int digits);

}  // namespace hydrapod::model
