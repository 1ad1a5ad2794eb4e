#pragma once
/// Reading typed values out of a table of the file. Private to the reader.
///
/// What cannot be read goes to Faults and is NaN in the machine, so that everything else can still
/// be judged: comparisons with NaN find nothing.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "faults.hpp"
#include "hydrapod/model/machine.hpp"
#include "value_tree.hpp"

namespace hydrapod::model {

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
  [[nodiscard]] Value find(std::string_view key) const;

  /// The table `key`. A required one that is missing is reported once, and then nothing in it is.
  [[nodiscard]] Section required_table(std::string_view key) const;
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
  void report_missing(std::string_view key, std::string_view what) const;
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

}  // namespace hydrapod::model
