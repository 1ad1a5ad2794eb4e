/// What is left of a record of hydrapod in an HDF5 or MATLAB 7.3 file that was cut off, or whose
/// writer was killed while HDF5 wrote its index.
///
/// HDF5 does not open a file that is shorter than its superblock says. The writer (hdf5_writer.cpp)
/// puts the header of the record before the first chunk of samples, so what stands before that
/// chunk is given to HDF5 as a file of its own, in memory, with the length that it has. The chunks
/// are found without HDF5: each leaf of their index (a B-tree of version 1) tells which rows stand
/// where, and where the next leaf is.
///
/// | layout of a leaf   | bytes                                                            |
/// | ------------------ | ---------------------------------------------------------------- |
/// | head               | "TREE", 1, level 0, number of chunks (2), leaf before and behind |
/// |                    | it (8 each)                                                      |
/// | per chunk, 40      | bytes (4), filters left out (4), first row, column and 0 (8      |
/// |                    | each), address (8)                                               |
///
/// Samples are taken from the first on, as long as a leaf names their chunk and the file holds
/// their bytes. What no leaf names is missing, whatever stands in the file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "file_window.hpp"
#include "formats.hpp"
#include "hdf5_text.hpp"
#include "hdf5_types.hpp"
#include "hydrapod/base/text.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

constexpr std::uint64_t nowhere = ~std::uint64_t{0};
constexpr std::uint64_t most_header_bytes = 128U << 20U;
constexpr std::uint64_t searched_bytes = 64U << 20U;  // for the first leaf
constexpr std::size_t leaf_head = 24, chunk_entry = 40, superblock_bytes = 96;

template <class Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number number{};
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

struct Chunk {
  std::uint64_t bytes{}, row{}, address{};
};

struct Leaf {
  std::uint64_t before{}, behind{};
  std::vector<Chunk> chunks{};
};

/// The dataset `samples`, as the header tells it.
struct Layout {
  std::uint64_t rows{}, columns{}, chunk_rows{};
  [[nodiscard]] std::uint64_t row_bytes() const { return columns * sizeof(double); }
  [[nodiscard]] std::uint64_t chunk_bytes() const { return chunk_rows * row_bytes(); }
};

/// None where it is not laid out as the writer does it.
std::optional<Layout> layout_of_samples(hid_t file) {
  const Hdf5Handle set(H5Dopen2(file, "samples", within_this_file(H5P_DATASET_ACCESS).id()),
                       H5Dclose);
  if (!set.ok()) return {};
  const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose), type(H5Dget_type(set.id()), H5Tclose),
      list(H5Dget_create_plist(set.id()), H5Pclose);
  std::array<hsize_t, 2> size{}, chunk{};
  const bool ours = H5Sget_simple_extent_ndims(space.id()) == 2 &&
                    H5Sget_simple_extent_dims(space.id(), size.data(), nullptr) == 2 &&
                    H5Tequal(type.id(), H5T_IEEE_F64LE) > 0 &&
                    H5Pget_layout(list.id()) == H5D_CHUNKED && H5Pget_nfilters(list.id()) == 0 &&
                    H5Pget_chunk(list.id(), 2, chunk.data()) == 2 && chunk[1] == size[1];
  constexpr hsize_t most = hsize_t{1} << 48U;
  if (!ours || chunk[0] == 0 || size[1] == 0 || size[0] > most || chunk[0] > most / 8 / size[1])
    return {};
  return Layout{size[0], size[1], chunk[0]};
}

class Hdf5Remains final : public VariableFile {
 public:
  Hdf5Remains(const std::string& path, Notes& notes) : file_(path), notes_(&notes) {
    find_superblock();
    const std::vector<std::uint64_t> first_leaves = find_first_leaves();
    open_header(first_leaves);
    const auto layout = layout_of_samples(header_.id());
    if (!layout) fail("its samples are not laid out as hydrapod writes them");
    layout_ = *layout;
    for (const std::uint64_t leaf : first_leaves) {
      auto found = chunks_from(leaf);
      if (found.size() > chunks_.size()) chunks_ = std::move(found);
    }
    const std::uint64_t rows = rows_that_are_there();
    if (rows == 0)
      fail(fmt::format("none of the {} samples that it declares is left", layout_.rows));
    use(rows);
    notes_ = nullptr;
  }

  bool read(std::size_t variable, std::uint64_t slow_first, std::uint64_t slow_count,
            std::uint64_t fast_first, std::uint64_t fast_count, double* out) override {
    if (variable != samples_)
      return inner_->read(variable, slow_first, slow_count, fast_first, fast_count, out);
    for (std::uint64_t row = slow_first; row < slow_first + slow_count; ++row, out += fast_count) {
      const std::uint64_t chunk = row / layout_.chunk_rows;
      if (chunk >= chunks_.size()) return false;
      const std::uint64_t at = base_ + chunks_[chunk] +
                               row % layout_.chunk_rows * layout_.row_bytes() +
                               fast_first * sizeof(double);
      if (!copy(at, fast_count * sizeof(double), reinterpret_cast<char*>(out))) return false;
    }
    return true;
  }

  bool read_all(std::size_t variable, std::vector<std::complex<double>>& out) override {
    return variable != samples_ && inner_->read_all(variable, out);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    notes_->fail("nothing can be recovered: " + why);
  }

  bool copy(std::uint64_t from, std::uint64_t bytes, char* to) {
    while (bytes > 0) {
      constexpr std::uint64_t piece = 1U << 16U;
      const auto wanted = static_cast<std::size_t>(std::min(bytes, piece));
      const std::string_view got = file_.at(from, wanted);
      if (got.size() < wanted) return false;
      std::memcpy(to, got.data(), wanted);
      from += wanted, to += wanted, bytes -= wanted;
    }
    return true;
  }

  void find_superblock() {
    constexpr std::string_view signature{"\x89HDF\r\n\x1a\n", 8};
    for (const std::uint64_t place : {0U, 512U}) {
      const std::string_view head = file_.at(place, superblock_bytes);
      if (head.size() < superblock_bytes || !head.starts_with(signature)) continue;
      const bool ours = head[8] == 0 && head[13] == 8 && head[14] == 8 &&
                        number_at<std::uint64_t>(head, 24) == place;
      if (!ours) fail("another program wrote the HDF5 file");
      base_ = place;
      return;
    }
    fail("the file is cut off within its first bytes");
  }

  /// The leaf at an address, where there is one.
  std::optional<Leaf> leaf_at(std::uint64_t address) {
    if (address >= file_.size()) return {};
    const std::string head(file_.at(base_ + address, leaf_head).substr(0, leaf_head));
    constexpr std::string_view mark{"TREE\1\0", 6};
    if (head.size() < leaf_head || !head.starts_with(mark)) return {};
    const std::size_t count = number_at<std::uint16_t>(head, 6);
    const std::string_view entries =
        file_.at(base_ + address + leaf_head, count * chunk_entry).substr(0, count * chunk_entry);
    constexpr std::size_t most = 64;  // in a file whose superblock has version 0
    if (count == 0 || count > most || entries.size() < count * chunk_entry) return {};
    Leaf leaf{number_at<std::uint64_t>(head, 8), number_at<std::uint64_t>(head, 16)};
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view entry = entries.substr(k * chunk_entry, chunk_entry);
      const bool plain = number_at<std::uint32_t>(entry, 4) == 0 &&
                         number_at<std::uint64_t>(entry, 16) == 0 &&
                         number_at<std::uint64_t>(entry, 24) == 0;
      if (!plain) return {};
      leaf.chunks.push_back({number_at<std::uint32_t>(entry, 0), number_at<std::uint64_t>(entry, 8),
                             number_at<std::uint64_t>(entry, 32)});
    }
    return leaf;
  }

  /// Addresses of leaves that begin with row 0: the first one, and where the writer was killed
  /// while its place changed, the one that it was made from.
  std::vector<std::uint64_t> find_first_leaves() {
    std::vector<std::uint64_t> found;
    constexpr std::string_view mark{"TREE\1\0", 6};
    constexpr std::size_t piece = 1U << 16U;
    const std::uint64_t end = std::min(file_.size(), base_ + searched_bytes);
    for (std::uint64_t at = base_; at < end;) {
      const std::string_view bytes = file_.at(at, piece);
      const std::size_t hit = bytes.find(mark);
      if (hit == bytes.npos) {
        if (bytes.size() < mark.size()) break;
        at += bytes.size() - mark.size() + 1;
        continue;
      }
      const std::uint64_t address = at + hit - base_;
      if (const auto leaf = leaf_at(address);
          leaf && leaf->before == nowhere && leaf->chunks.front().row == 0)
        found.push_back(address);
      at += hit + 1;
    }
    if (found.empty())
      fail(holds_mark() ? "the file is cut off before the index of its samples"
                        : "no index of samples is found: the file is cut off before it, or another "
                          "program wrote it");
    return found;
  }

  /// In the header of a record of hydrapod, which stands before its samples.
  bool holds_mark() {
    const std::string mark = record_mark;
    std::string wide;  // as MATLAB has it, in UTF-16
    for (const char letter : mark) wide += {letter, '\0'};
    constexpr std::size_t piece = 1U << 16U;
    for (std::uint64_t at = base_; at < std::min(file_.size(), base_ + searched_bytes);) {
      const std::string_view bytes = file_.at(at, piece);
      if (bytes.find(mark) != bytes.npos || bytes.find(wide) != bytes.npos) return true;
      if (bytes.size() < wide.size()) break;
      at += bytes.size() - wide.size() + 1;
    }
    return false;
  }

  /// What stands before the samples, as a file that ends there.
  void open_header(const std::vector<std::uint64_t>& first_leaves) {
    const std::uint64_t end = base_ + leaf_at(first_leaves.front())->chunks.front().address;
    if (end < base_ + superblock_bytes || end > std::min(file_.size(), most_header_bytes))
      fail("the file is cut off before its samples");
    header_end_ = end;
    std::vector<char> image(end);
    if (!copy(0, end, image.data())) fail("it cannot be read");
    constexpr std::size_t end_of_file = 40;  // in the superblock
    std::memcpy(image.data() + base_ + end_of_file, &end, sizeof end);
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    constexpr std::size_t growth = 1U << 16U;
    H5Pset_fapl_core(access.id(), growth, false);
    H5Pset_file_image(access.id(), image.data(), image.size());
    constexpr const char* no_file = "/dev/null/header";  // HDF5 looks for one of that name
    header_ = {H5Fopen(no_file, H5F_ACC_RDONLY, access.id()), H5Fclose};
    if (!header_.ok()) fail("its header is damaged");
    Notes inner(notes_->file());
    constexpr std::uint64_t any = std::uint64_t{1} << 48U;  // what is left of `samples` leaves tell
    inner_ = hdf5_variables(header_.id(), any, inner);
    for (const auto& note : inner.all())
      if (!note.message.starts_with("'samples' ")) notes_->add(note.message);
    variables_ = inner_->variables();
    format_ = inner_->format();
    const Variable* format = find("format");
    if (format == nullptr || format->text != record_mark) fail("it is no record of hydrapod");
  }

  Variable* find(const std::string& name) {
    const auto at = std::ranges::find(variables_, name, &Variable::name);
    return at == variables_.end() ? nullptr : &*at;
  }

  /// Addresses of the chunks from the first on, as far as leaves that fit together name them.
  std::vector<std::uint64_t> chunks_from(std::uint64_t address) {
    std::vector<std::uint64_t> chunks;
    for (std::uint64_t before = nowhere; address != nowhere;) {
      const auto leaf = leaf_at(address);
      if (!leaf || leaf->before != before) break;
      for (const Chunk& chunk : leaf->chunks) {
        if (chunk.bytes != layout_.chunk_bytes() ||
            chunk.row != chunks.size() * layout_.chunk_rows || !follows(chunks, chunk.address))
          return chunks.size() > 1 ? chunks : std::vector<std::uint64_t>{};  // either may be wrong
        chunks.push_back(chunk.address);
      }
      before = address;
      address = leaf->behind;
    }
    return chunks;
  }

  /// The writer puts one chunk behind the other; between two is nothing, or room for leaves.
  bool follows(const std::vector<std::uint64_t>& chunks, std::uint64_t address) {
    if (chunks.empty()) return base_ + address == header_end_;
    const std::uint64_t end = chunks.back() + layout_.chunk_bytes();
    if (address == end) return true;
    constexpr std::uint64_t leaf_bytes = 2616, most = 1U << 16U;
    return address >= end + leaf_bytes && address <= end + most &&
           (base_ + end >= file_.size() || file_.at(base_ + end, 4).starts_with("TREE"));
  }

  [[nodiscard]] std::uint64_t rows_that_are_there() const {
    std::uint64_t rows = 0;
    for (const std::uint64_t chunk : chunks_) {
      const std::uint64_t left = file_.size() - std::min(file_.size(), base_ + chunk);
      const std::uint64_t here = std::min(left / layout_.row_bytes(), layout_.chunk_rows);
      rows += here;
      if (here < layout_.chunk_rows) break;
    }
    return std::min(rows, layout_.rows);
  }

  void use(std::uint64_t rows) {
    Variable* samples = find("samples");
    if (samples == nullptr) fail("its header is damaged");
    samples_ = static_cast<std::size_t>(samples - variables_.data());
    samples->fast = layout_.columns;
    samples->slow = rows;
    samples->sizes = {layout_.columns, rows};
    samples->declared = 0;
    if (rows == layout_.rows)
      return notes_->add("the file is cut off or damaged behind its samples");
    samples->declared = layout_.rows;
    notes_->add(fmt::format("the file is cut off: {} of the {} samples that it declares are there",
                            rows, layout_.rows));
  }

  FileWindow file_;
  Notes* notes_;
  std::uint64_t base_{};  ///< where the HDF5 file begins; addresses count from there
  std::uint64_t header_end_{};
  Hdf5Handle header_;
  std::unique_ptr<VariableFile> inner_;
  Layout layout_{};
  std::vector<std::uint64_t> chunks_;  ///< addresses
  std::size_t samples_{};              ///< among the variables
};

}  // namespace

std::unique_ptr<VariableFile> open_hdf5_remains_here(const std::string& path, Notes& notes) {
  const Hdf5Silence silence;
  return std::make_unique<Hdf5Remains>(path, notes);
}

}  // namespace hydrapod::data
