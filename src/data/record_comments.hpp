#pragma once
/// The header of a record as lines of text that begin with '#': in CSV files and, as a dataset of
/// hydrapod's own, in Universal Files.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// All of `header`; each line ends with a line feed.
std::string comment_lines(const RecordHeader& header);

/// Takes such lines and makes a header of them.
class RecordComments {
 public:
  /// `line` may be any comment, also one of another program.
  void take(std::string_view line, unsigned number);

  /// Were there lines that comment_lines() made? Throws base::InputError for another version.
  [[nodiscard]] bool by_hydrapod(const Notes& notes) const;

  /// The text of a key, all its lines; empty where there is none.
  [[nodiscard]] std::string text_of(const std::string& key) const;

  /// Throws base::InputError where a line does not hold what it should. Names and units are as they
  /// stand; the sample rate is 0 where none was given.
  [[nodiscard]] RecordHeader header(Notes& notes) const;

 private:
  struct Line {
    std::string text{};
    unsigned number{};
  };
  [[nodiscard]] double number_of(const std::string& key, double otherwise,
                                 const Notes& notes) const;
  [[nodiscard]] static Channel channel_of(const Line& line, const Notes& notes);

  std::map<std::string, std::vector<Line>> lines_;  ///< "# key: value" by key
};

}  // namespace hydrapod::data
