#pragma once
/// Reading typed values out of a table of the file.
///
/// What cannot be read goes to Faults and is NaN in the machine, so that everything else can still
/// be judged: comparisons with NaN find nothing.
///
/// A machine file as a tree of values that know where they came from.
///
/// toml++ parses; its tables are sorted by key and forget places when they are copied. Here the
/// order of the file is kept, and a value laid over the file by an override knows the override.
///
/// What the reader finds wrong, until it is told to whoever asked.
///
/// Dotted paths such as `legs.rod.length`, `platform.mass_center[2]`, `poses."far left".position`.

#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::model {

/// Stands in the machine for a number that could not be read.
inline constexpr double unread = std::numeric_limits<double>::quiet_NaN();

/// A spring in N/m or N m/rad may be the word "rigid". Where a part is rigid when it is left out,
/// it is left out; elsewhere the spring gets this stiffness, a hundred thousand times those of
/// machines.
inline constexpr std::string_view rigid_word = "rigid";
inline constexpr double rigid_stiffness = 1e12;
/// The largest stiffness of a spring. Rounding of a stiffness matrix that holds it is 0.2 N/m.
inline constexpr double stiffest = 1e15;
[[nodiscard]] constexpr bool is_spring_rate(std::string_view unit) {
  return unit == "N/m" || unit == "N m/rad";
}

/// Where a value stands. `source` is 0 for the file, i for the i-th override; lines and columns
/// count from 1, and an override has line 0.
struct Place {
  int source{};
  unsigned line{};
  unsigned column{};
};

struct Node {
  enum class Kind { table, array, text, integer, real, boolean, date };

  Kind kind{Kind::table};
  Place place{};                 ///< of the value
  Place key_place{};             ///< of the key, where it has one
  std::string key{};             ///< in the parent table
  std::string text{};            ///< Kind::text
  double number{};               ///< Kind::integer, Kind::real
  std::vector<Node> children{};  ///< of a table in the order of the file, or of an array

  [[nodiscard]] bool is_table() const { return kind == Kind::table; }
  [[nodiscard]] bool is_number() const { return kind == Kind::integer || kind == Kind::real; }
  [[nodiscard]] const Node* find(std::string_view name) const;
  Node* find(std::string_view name);
};

/// What a value is, with its article, for messages: "the number 3", "a table".
std::string described(const Node& node);

/// A TOML syntax error.
struct SyntaxError {
  Place place{};
  std::string message{};
};

/// The tree of a TOML text whose places are of `source`. Text that is not UTF-8, or nested so
/// deeply that no machine can be meant, is a syntax error too.
std::variant<Node, SyntaxError> parse_tree(std::string_view text, int source);

class Faults {
 public:
  /// `sources` names the file and the overrides, as Place::source counts them.
  explicit Faults(std::vector<std::string> sources) : sources_(std::move(sources)) {}

  /// Records a mistake; the same one (six legs share a table) is recorded once.
  void add(const Place& place, std::string key, std::string message,
           base::Severity severity = base::Severity::error);

  /// Says that a value could not be read and the machine therefore holds a NaN.
  void mark_incomplete() { incomplete_ = true; }
  [[nodiscard]] bool incomplete() const { return incomplete_; }

  /// Says that `path` is absent because it was misspelt, which has been reported.
  void mark_misspelt(std::string path) { misspelt_.insert(std::move(path)); }
  [[nodiscard]] bool misspelt(const std::string& path) const { return misspelt_.contains(path); }

  [[nodiscard]] bool any_error() const { return errors_ > 0; }

  /// Everything of that severity in the order of the file, then of the overrides.
  [[nodiscard]] std::vector<base::Diagnostic> diagnostics(base::Severity severity) const;

 private:
  struct Fault {
    Place place{};
    base::Diagnostic diagnostic{};
  };

  std::vector<std::string> sources_;
  std::vector<Fault> faults_;
  std::set<std::string> misspelt_;
  std::size_t errors_{};
  std::size_t not_kept_{};
  bool incomplete_{};
};

/// One table of the file; for one leg, its own table laid over the one of all legs. Nothing is
/// copied: each value is looked up in the specific table first, then in the general one.
class Section {
 public:
  /// A value and the path by which messages call it.
  struct Value {
    const Node* node{};
    std::string path{};
    explicit operator bool() const { return node != nullptr; }
  };

  /// The top level of the file.
  Section(const Node& root, Faults& faults);

  /// `specific` over `general`, for instance leg.3 over legs.
  static Section overlaid(const Section& specific, const Section& general);

  /// A table at `path` of the file, for instance an element of an array of tables.
  static Section at(const Node& table, std::string path, Faults& faults);

  [[nodiscard]] bool exists() const {
    return specific_.node != nullptr || general_.node != nullptr;
  }
  [[nodiscard]] bool has(std::string_view key) const { return static_cast<bool>(find(key)); }
  /// Is it there, or was it misspelt?
  [[nodiscard]] bool is_meant(std::string_view key) const { return has(key) || is_misspelt(key); }
  [[nodiscard]] Value find(std::string_view key) const;

  /// The table `key`. A required one that is missing is reported once, with `advice` behind the
  /// message, and then nothing in it is.
  [[nodiscard]] Section required_table(std::string_view key, std::string_view advice = {}) const;
  [[nodiscard]] Section optional_table(std::string_view key) const;

  /// Which of two keys that exclude each other is given; the specific table counts before the
  /// general one. Both in one table is reported. Empty when neither is there.
  [[nodiscard]] std::string_view choice(std::string_view first, std::string_view second) const;

  /// Quantities in `unit` ("m", "1" for pure numbers): required, with a default, or optional.
  [[nodiscard]] double number(std::string_view key, std::string_view unit) const;
  [[nodiscard]] double number(std::string_view key, std::string_view unit, double fallback) const;
  [[nodiscard]] std::optional<double> optional_number(std::string_view key,
                                                      std::string_view unit) const;
  [[nodiscard]] Vector3 vector(std::string_view key, std::string_view unit) const;
  [[nodiscard]] Vector3 vector(std::string_view key, std::string_view unit,
                               const Vector3& fallback) const;

  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] std::string optional_text(std::string_view key) const;
  /// One of `words`, of which the first is the default; returns its position.
  [[nodiscard]] std::size_t word(std::string_view key,
                                 std::span<const std::string_view> words) const;

  /// The quantity that `value` is; NaN after reporting why it is none.
  [[nodiscard]] double read_number(const Value& value, std::string_view unit) const;
  /// An array of `size` quantities; NaNs after reporting.
  [[nodiscard]] std::vector<double> read_array(const Value& value, std::size_t size,
                                               std::string_view unit) const;
  [[nodiscard]] Vector3 read_vector(const Value& value, std::string_view unit) const;
  /// The elements of the array that `value` is, if it has `size` of them; reported otherwise.
  [[nodiscard]] std::vector<Value> elements(const Value& value, std::size_t size,
                                            std::string_view what) const;

  /// Element `i` of an array; without a node where there is none.
  [[nodiscard]] static Value element(const Value& array, std::size_t i);

  /// The path at which a missing key is reported.
  [[nodiscard]] std::string missing_path(std::string_view key) const;
  void report_missing(std::string_view key, std::string_view what,
                      std::string_view advice = {}) const;
  void report_missing_numbers(std::string_view key, std::string_view unit, std::size_t size) const;
  void report(const Value& value, std::string message) const;

 private:
  /// A table that may be absent; `place` is then that of the nearest table above it.
  struct Table {
    const Node* node{};
    std::string path{};
    Place place{};
  };

  Section(Table specific, Table general, bool silent, Faults& faults);
  static Table below(const Table& table, std::string_view key);
  [[nodiscard]] bool is_misspelt(std::string_view key) const;
  /// The table that ought to have a missing key: what legs may share belongs in that of all legs.
  [[nodiscard]] const Table& lacking() const;

  Table specific_{};
  Table general_{};
  bool silent_{};  ///< what is missing has been reported already
  Faults* faults_;
};

/// A key of a table, or an element of an array.
struct PathStep {
  std::string key{};
  std::optional<std::size_t> index{};
};
using KeyPath = std::vector<PathStep>;

/// Reads a path; none when it is not one, or has more than 32 steps.
std::optional<KeyPath> parse_path(std::string_view text);

std::string to_string(const KeyPath& path);

/// `key` as it must be written in a path: bare, or in quotes.
std::string written_key(std::string_view key);

/// `parent.key`, or the key alone at the top level.
std::string joined_path(std::string_view parent, std::string_view key);

/// The node at `path` below `root`, or null.
const Node* find_node(const Node& root, const KeyPath& path);

}  // namespace hydrapod::model
