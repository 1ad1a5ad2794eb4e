#pragma once
/// A text file line by line, with a bound on how long a line may be.

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::data {

class LineReader {
 public:
  /// Throws base::InputError when the file cannot be opened.
  explicit LineReader(const std::string& path);

  /// The next line without its end (LF, CR LF or CR); false at the end of the file. The view holds
  /// until the next call. Throws base::InputError for a line longer than `longest`.
  bool next(std::string_view& line);

  /// Of the line that next() gave last, from 1.
  [[nodiscard]] unsigned number() const { return number_; }
  /// False when the file ended within the line that next() gave last.
  [[nodiscard]] bool line_was_ended() const { return ended_; }

  static constexpr std::size_t longest = 16U << 20U;  ///< bytes

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool refill();

  std::string path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::vector<char> buffer_;
  std::size_t begin_{}, end_{};  ///< of what has not been given yet in buffer_
  unsigned number_{};
  bool ended_{true};
  bool at_end_{};
};

}  // namespace hydrapod::data
