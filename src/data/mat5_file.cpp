/// MAT files of version 5, read without believing any size that they declare.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "channel_units.hpp"
#include "hydrapod/base/text.hpp"
#include "mat5_stream.hpp"
#include "unicode.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

constexpr int deepest_structure = 4;  // structures in structures
constexpr std::size_t most_fields = 10'000;
constexpr std::uint64_t most_structures = 1000;  // in one list
constexpr std::size_t most_cursors = 512;

/// A place where the file does not make sense.
struct Damaged {
  std::string what;
};

struct Tag {
  std::uint32_t type{};
  std::uint32_t bytes{};
  bool small{};  ///< the data stand within the tag
  std::array<char, 4> within{};
};

/// Where the numbers of a variable stand.
struct Place {
  std::uint64_t begin{}, end{};  ///< of its element in the file
  bool compressed{};
  std::uint64_t data{};  ///< offset of the numbers within the element
  bool small{};          ///< they stand within their tag
  std::uint32_t type{};
};

class Mat5File final : public VariableFile {
 public:
  Mat5File(const std::string& path, Notes& notes) : file_(path), notes_(&notes) {
    const std::string_view header = file_.at(0, mat5_header_bytes);
    if (header.size() < mat5_header_bytes)
      notes.fail("the MAT file is cut off within its header of 128 bytes");
    const std::string_view order = header.substr(126, 2);
    if (order != "IM" && order != "MI")
      notes.fail("the MAT file has no mark of its byte order (IM or MI) at byte 126");
    swapped_ = order == "MI";
    format_ = RecordFormat::mat5;
    for (offset_ = mat5_header_bytes; offset_ < file_.size();)
      if (!take_element()) break;
    notes_ = nullptr;  // it lives no longer than this
  }

  bool read(std::size_t variable, std::uint64_t slow_first, std::uint64_t slow_count,
            std::uint64_t fast_first, std::uint64_t fast_count, double* out) override {
    const Variable& v = variables_[variable];
    const bool part = fast_count < v.fast;
    const std::uint64_t first = slow_first * v.fast + fast_first;
    const std::uint64_t count = slow_count * fast_count;
    if (const auto at = broken_.find(variable); at != broken_.end() && first + count > at->second)
      return false;
    Cursor& cursor = cursor_at(variable, part ? slow_first : ~std::uint64_t{0}, first);
    if (!cursor.stream) return false;
    if (read_items(cursor, places_[variable].type, first, count, out)) return true;
    if (cursor.stream->broken()) broken_.try_emplace(variable, first);
    cursor.stream.reset();
    return false;
  }

  bool read_all(std::size_t variable, std::vector<std::complex<double>>& out) override {
    const Variable& v = variables_[variable];
    const Place& place = places_[variable];
    const std::uint64_t count = v.fast * v.slow;
    if (count > most_in_memory) return false;
    Mat5Stream stream(file_, place.begin, place.end, place.compressed);
    if (!stream.skip(place.data)) return false;
    std::vector<double> real, imaginary;
    if (!take_items(stream, place.type, count, real)) return false;
    if (v.is_complex) {
      const std::uint64_t bytes = count * mat5_item_bytes(place.type);
      if (!stream.skip(place.small ? 4 - bytes : (8 - bytes % 8) % 8)) return false;
      try {
        const Tag second = tag(stream);
        const std::string within(second.within.data(), second.within.size());
        const std::size_t size = mat5_item_bytes(second.type);
        if (size == 0 || second.bytes < count * size) return false;
        if (second.small)
          for (std::uint64_t k = 0; k < count; ++k)
            imaginary.push_back(mat5_item(within.data() + k * size, second.type, swapped_));
        else if (!take_items(stream, second.type, count, imaginary))
          return false;
      } catch (const Damaged&) {
        return false;
      }
    }
    out.resize(count);
    for (std::uint64_t k = 0; k < count; ++k)
      out[k] = {real[k], imaginary.empty() ? 0.0 : imaginary[k]};
    return true;
  }

 private:
  struct Cursor {
    std::unique_ptr<Mat5Stream> stream{};
    std::uint64_t next{};  ///< item that comes next
  };

  bool read_items(Cursor& cursor, std::uint32_t type, std::uint64_t first, std::uint64_t count,
                  double* out) const {
    const std::size_t size = mat5_item_bytes(type);
    if (!cursor.stream->skip((first - cursor.next) * size)) return false;
    cursor.next = first + count;
    std::array<char, 8192> buffer{};
    for (std::uint64_t done = 0; done < count;) {
      const std::size_t items = std::min<std::uint64_t>(count - done, buffer.size() / size);
      if (!cursor.stream->read(buffer.data(), items * size)) return false;
      for (std::size_t i = 0; i < items; ++i)
        out[done + i] = mat5_item(buffer.data() + i * size, type, swapped_);
      done += items;
    }
    return true;
  }

  /// The next `count` numbers; memory grows with what is there.
  bool take_items(Mat5Stream& stream, std::uint32_t type, std::uint64_t count,
                  std::vector<double>& out) const {
    const std::size_t size = mat5_item_bytes(type);
    std::array<char, 8192> buffer{};
    while (size > 0 && out.size() < count) {
      const std::size_t items = std::min<std::uint64_t>(count - out.size(), buffer.size() / size);
      if (!stream.read(buffer.data(), items * size)) return false;
      for (std::size_t i = 0; i < items; ++i)
        out.push_back(mat5_item(buffer.data() + i * size, type, swapped_));
    }
    return out.size() == count;
  }

  /// A stream that stands at or before item `first`.
  Cursor& cursor_at(std::size_t variable, std::uint64_t line, std::uint64_t first) {
    const auto key = std::make_pair(variable, line);
    if (!cursors_.contains(key) && cursors_.size() >= most_cursors)
      cursors_.erase(cursors_.begin());
    Cursor& cursor = cursors_[key];
    if (!cursor.stream || cursor.next > first) {
      const Place& place = places_[variable];
      cursor.stream = std::make_unique<Mat5Stream>(file_, place.begin, place.end, place.compressed);
      cursor.next = 0;
      if (!cursor.stream->skip(place.data)) cursor.stream.reset();
    }
    return cursor;
  }

  [[nodiscard]] std::uint32_t word(const char* bytes) const {
    return static_cast<std::uint32_t>(mat5_item(bytes, mat5_type::uint32, swapped_));
  }

  Tag tag(Mat5Stream& stream) const {
    std::array<char, 8> bytes{};
    if (!stream.read(bytes.data(), bytes.size())) throw Damaged{"it is cut off"};
    const std::uint32_t first = word(bytes.data());
    if (first >> 16U != 0) {
      Tag small{first & 0xFFFFU, first >> 16U, true, {}};
      if (small.bytes > 4) throw Damaged{"a small element declares more than 4 bytes"};
      std::copy_n(bytes.data() + 4, 4, small.within.begin());
      return small;
    }
    return {first, word(bytes.data() + 4), false, {}};
  }

  /// The data of an element that must not be long.
  std::string data(Mat5Stream& stream, const Tag& tag, std::size_t most) const {
    if (tag.small) return {tag.within.data(), tag.bytes};
    if (tag.bytes > most || tag.bytes > stream.most_left())
      throw Damaged{fmt::format("an element declares {} bytes, more than there can be", tag.bytes)};
    std::string bytes;
    constexpr std::size_t step = 1U << 16U;
    while (bytes.size() < tag.bytes) {  // grows with what is there, not with what is declared
      const std::size_t before = bytes.size();
      bytes.resize(std::min<std::size_t>(before + step, tag.bytes));
      if (!stream.read(bytes.data() + before, bytes.size() - before))
        throw Damaged{"it is cut off"};
    }
    if (!stream.skip((8 - tag.bytes % 8) % 8)) throw Damaged{"it is cut off"};
    return bytes;
  }

  /// One element of the file; false when there is no sense in going on.
  bool take_element() {
    ++elements_;
    const std::string_view bytes = file_.at(offset_, 8);
    if (bytes.size() < 8) {
      notes_->add(fmt::format("the file is cut off within the tag at byte {}", offset_));
      return false;
    }
    const std::uint32_t type = word(bytes.data()), size = word(bytes.data() + 4);
    const std::uint64_t begin = offset_ + 8;
    const std::string where = fmt::format("variable {} (at byte {})", elements_, offset_);
    if (type != mat5_type::matrix && type != mat5_type::compressed) {
      notes_->add(fmt::format(
          "{}: element type {} is not one of a variable; what follows is left out", where, type));
      return false;
    }
    if (size > file_.size() - begin)
      notes_->add(fmt::format("{} declares {} bytes, but only {} are left in the file", where, size,
                              file_.size() - begin));
    offset_ = begin + size;
    Place place{begin, std::min<std::uint64_t>(offset_, file_.size()),
                type == mat5_type::compressed};
    try {
      Mat5Stream stream(file_, place.begin, place.end, place.compressed);
      std::uint64_t inner = size;
      if (place.compressed) {
        const Tag matrix = tag(stream);
        if (matrix.type != mat5_type::matrix) throw Damaged{"what is compressed is no array"};
        inner = matrix.bytes;
      }
      take_array(stream, inner, place, "", 0);
    } catch (const Damaged& damaged) {
      notes_->add(fmt::format("{}: {}; left out", where, damaged.what));
    }
    return true;
  }

  struct Array {
    std::uint32_t kind{};
    bool is_complex{};
    std::uint64_t fast{1}, slow{1};
    std::vector<std::uint64_t> sizes{};
    std::string name{};
    std::uint64_t end{};  ///< position in the stream
  };

  Array array_head(Mat5Stream& stream, std::uint64_t bytes) const {
    Array array;
    array.end = stream.position() + bytes;
    const std::string flags = data(stream, tag(stream), 8);
    if (flags.size() != 8) throw Damaged{"the array flags have not 8 bytes"};
    const std::uint32_t word0 = word(flags.data());
    array.kind = word0 & 0xFFU;
    array.is_complex = (word0 & 0x0800U) != 0;
    const std::string sizes = data(stream, tag(stream), 4U * 32U);
    if (sizes.size() < 8 || sizes.size() % 4 != 0)
      throw Damaged{"it has fewer than two dimensions"};
    for (std::size_t i = 0; i < sizes.size() / 4; ++i) {
      const std::uint64_t size = word(sizes.data() + 4 * i);
      array.sizes.push_back(size);
      if (i == 0)
        array.fast = size;
      else if (size == 0 || array.slow <= (std::uint64_t{1} << 48U) / size)
        array.slow *= size;
      else
        throw Damaged{"its dimensions are beyond any file"};
    }
    if (array.fast != 0 && array.slow > (std::uint64_t{1} << 48U) / array.fast)
      throw Damaged{"its dimensions are beyond any file"};
    array.name = clean_text(data(stream, tag(stream), 4096));
    return array;
  }

  /// An array of `bytes` bytes and what is in it, called prefix.name.
  void take_array(Mat5Stream& stream, std::uint64_t bytes, const Place& place,
                  const std::string& prefix, int depth) {
    if (bytes == 0) return;  // an empty field
    Array array = array_head(stream, bytes);
    const std::string name = array.name.empty() ? prefix : array.name;
    if (array.kind == mat5_class::structure)
      take_structure(stream, array, place, name, depth);
    else if (array.kind == mat5_class::cell)
      take_cell(stream, array, name);
    else if (array.kind == mat5_class::character)
      take_text(stream, array, name);
    else if (array.kind >= mat5_class::double_float && array.kind <= mat5_class::uint64)
      take_numbers(stream, array, place, name);
    else
      notes_->add(fmt::format("variable '{}' is of class {}, which is not read: left out",
                              base::printable(name), array.kind));
    if (array.end > stream.position() && depth > 0 && !stream.skip(array.end - stream.position()))
      throw Damaged{"it is cut off"};
  }

  void take_numbers(Mat5Stream& stream, const Array& array, Place place, const std::string& name) {
    Variable v{.name = name, .fast = array.fast, .slow = array.slow};
    v.sizes = array.sizes;
    v.is_complex = array.is_complex;
    const Tag numbers =
        v.fast * v.slow == 0 && stream.position() >= array.end ? Tag{} : tag(stream);
    place.type = numbers.type;
    place.data = stream.position() - (numbers.small ? 4 : 0);
    place.small = numbers.small;
    const std::size_t size = mat5_item_bytes(numbers.type);
    if (size == 0 && v.fast * v.slow > 0)
      throw Damaged{fmt::format("its numbers are of the unknown type {}", numbers.type)};
    const std::uint64_t bytes =
        numbers.small ? numbers.bytes : std::min<std::uint64_t>(numbers.bytes, stream.most_left());
    const std::uint64_t held = size == 0 ? 0 : bytes / size;
    if (held < v.fast * v.slow) {
      notes_->add(fmt::format("variable '{}' is declared as {} × {}, but {} numbers are there",
                              base::printable(name), v.fast, v.slow, held));
      v.declared = v.slow > 1 ? v.slow : v.fast;
      if (v.slow > 1)
        v.slow = held / v.fast;
      else
        v.fast = held;
      v.sizes = {v.fast, v.slow};
    }
    std::array<char, 8> first{};
    if (v.fast * v.slow == 1) {
      if (numbers.small)
        std::copy_n(numbers.within.begin(), 4, first.begin());
      else if (!stream.read(first.data(), size))
        throw Damaged{"it is cut off"};
      v.number = mat5_item(first.data(), numbers.type, swapped_);
    }
    places_.push_back(place);
    variables_.push_back(std::move(v));
  }

  /// The rows of an array of characters.
  std::vector<std::string> rows_of_text(Mat5Stream& stream, const Array& array) const {
    if (array.fast * array.slow == 0 || stream.position() >= array.end) return {""};
    const Tag characters = tag(stream);
    const std::size_t size = mat5_item_bytes(characters.type);
    if (size == 0 || size > 4)
      throw Damaged{fmt::format("its characters are of the unknown type {}", characters.type)};
    const std::string bytes = data(stream, characters, longest_text);
    if (characters.type == mat5_type::utf8 && array.fast == 1) return {bytes};
    const std::size_t count = bytes.size() / size;
    const std::size_t rows = std::min<std::uint64_t>(std::max<std::uint64_t>(array.fast, 1), count);
    std::vector<std::string> texts;
    for (std::size_t row = 0; row < rows; ++row) {
      std::vector<std::uint32_t> units;
      for (std::size_t i = row; i < count; i += rows)
        units.push_back(static_cast<std::uint32_t>(mat5_item(bytes.data() + i * size,
                                                             size == 1   ? mat5_type::uint8
                                                             : size == 2 ? mat5_type::uint16
                                                                         : mat5_type::uint32,
                                                             swapped_)));
      texts.push_back(utf8_from(units));
    }
    return texts.empty() ? std::vector<std::string>{""} : texts;
  }

  void take_text(Mat5Stream& stream, const Array& array, const std::string& name) {
    Variable v{.name = name, .kind = VariableKind::text};
    auto rows = rows_of_text(stream, array);
    if (rows.size() == 1) {
      v.text = rows.front();
    } else {
      v.kind = VariableKind::texts;
      for (std::string& row : rows) row.erase(row.find_last_not_of(" \0") + 1);
      v.texts = std::move(rows);
    }
    places_.push_back({});
    variables_.push_back(std::move(v));
  }

  /// A list of texts; other cells are left out.
  void take_cell(Mat5Stream& stream, const Array& array, const std::string& name) {
    Variable v{.name = name, .kind = VariableKind::texts};
    for (std::uint64_t i = 0; i < array.fast * array.slow; ++i) {
      const Tag element = tag(stream);
      if (element.type != mat5_type::matrix) throw Damaged{"a cell holds no array"};
      if (element.bytes == 0) {
        v.texts.emplace_back();
        continue;
      }
      const Array inner = array_head(stream, element.bytes);
      if (inner.kind != mat5_class::character) {
        notes_->add(fmt::format("variable '{}' is a cell array with more than texts: left out",
                                base::printable(name)));
        return;
      }
      v.texts.push_back(rows_of_text(stream, inner).front());
      if (inner.end > stream.position() && !stream.skip(inner.end - stream.position()))
        throw Damaged{"it is cut off"};
    }
    places_.push_back({});
    variables_.push_back(std::move(v));
  }

  void take_structure(Mat5Stream& stream, const Array& array, const Place& place,
                      const std::string& name, int depth) {
    const std::string width = data(stream, tag(stream), 4);
    if (width.size() != 4) throw Damaged{"its fields have no length of names"};
    const std::uint32_t length = word(width.data());
    const std::string names = data(stream, tag(stream), most_fields * 64);
    if (length == 0 || length > 4096 || names.size() % length != 0)
      throw Damaged{"the names of its fields make no sense"};
    const std::uint64_t count = array.fast * array.slow;
    if (count == 0 || count > most_structures || depth == deepest_structure)
      return notes_->add(fmt::format("variable '{}' is a list of structures or too deep: left out",
                                     base::printable(name)));
    for (std::uint64_t e = 0; e < count; ++e) {
      const std::string one = count == 1 ? name : fmt::format("{}({})", name, e + 1);
      for (std::size_t i = 0; i < names.size() / length; ++i) {
        const Tag element = tag(stream);
        if (element.type != mat5_type::matrix) throw Damaged{"a field holds no array"};
        const std::string field(names.data() + i * length,
                                strnlen(names.data() + i * length, length));
        take_array(stream, element.bytes, place, one + '.' + clean_text(field), depth + 1);
      }
    }
  }

  FileWindow file_;
  Notes* notes_;
  bool swapped_{};
  std::uint64_t offset_{};
  std::size_t elements_{};
  std::vector<Place> places_;
  std::map<std::pair<std::size_t, std::uint64_t>, Cursor> cursors_;
  std::map<std::size_t, std::uint64_t> broken_;  ///< first item that cannot be trusted, by variable
};

}  // namespace

std::unique_ptr<VariableFile> open_mat5_file(const std::string& path, Notes& notes) {
  return std::make_unique<Mat5File>(path, notes);
}

}  // namespace hydrapod::data
