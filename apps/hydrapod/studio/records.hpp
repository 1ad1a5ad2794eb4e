#pragma once
/// Measured files that the studio knows: those of the command line, and those that a page sent.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/report/json.hpp"

namespace hydrapod::studio {

/// A folder of this user alone, which goes with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  [[nodiscard]] const std::string& path() const { return path_; }
  /// A name in it that nothing has yet: a new folder's, and `name` in that.
  std::string place_for(const std::string& name);

 private:
  std::string path_;
  int count_{};
};

class Records {
 public:
  static constexpr std::size_t most = 100;
  static constexpr std::uint64_t most_bytes = 4ULL << 30U;  ///< of all that pages sent

  explicit Records(TemporaryFolder& folder) : folder_(folder) {}

  /// Of the command line.
  void add(const std::string& path) { all_.push_back({path, path, true}); }
  /// Where the file that a page calls `name` goes: letters, digits, - and _ of the name, and its
  /// ending. Throws base::InputError where there are too many.
  std::string place_for(const std::string& name);
  /// The file has come.
  std::size_t arrived(const std::string& name, const std::string& place);
  void discard(const std::string& place);

  [[nodiscard]] const std::string& path(std::size_t number) const { return all_.at(number).path; }
  [[nodiscard]] std::size_t count() const { return all_.size(); }
  [[nodiscard]] report::Json json() const;

 private:
  struct Record {
    std::string path{}, name{};
    bool given{};
  };
  TemporaryFolder& folder_;
  std::vector<Record> all_{};
};

}  // namespace hydrapod::studio
