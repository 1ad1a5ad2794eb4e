/// HDF5 files of other programs and MATLAB 7.3 files as named arrays.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "channel_units.hpp"
#include "formats.hpp"
#include "hdf5_text.hpp"
#include "hdf5_types.hpp"
#include "hydrapod/base/text.hpp"
#include "unicode.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

constexpr int deepest_group = 6;
constexpr std::size_t most_variables = 20'000;
constexpr std::uint64_t most_cache_bytes = 256U << 20U;  // of chunks that are larger than usual

class Hdf5Variables final : public VariableFile {
 public:
  Hdf5Variables(Hdf5Handle file, std::uint64_t file_bytes, Notes& notes)
      : file_bytes_(file_bytes), file_(std::move(file)) {
    if (!file_.ok()) notes.fail(hdf5_not_opened);
    const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    notes_ = &notes;
    if (H5O_info_t info{}; H5Oget_info2(root.id(), &info, H5O_INFO_BASIC) >= 0)
      groups_.insert(info.addr);
    take_attributes(root.id());
    take_group(root.id(), "", 0);
    notes_ = nullptr;
  }

  bool read(std::size_t variable, std::uint64_t slow_first, std::uint64_t slow_count,
            std::uint64_t fast_first, std::uint64_t fast_count, double* out) override {
    const Hdf5Silence silence;
    if (slow_count == 0 || fast_count == 0) return true;
    const Set& set = sets_[variable];
    const bool lines = set.rank == 2 || set.width > 1;  // slow_first counts the rows
    const Hdf5Handle space(H5Dget_space(set.set.id()), H5Sclose);
    const hsize_t from[2] = {lines ? slow_first : fast_first, fast_first};
    const hsize_t count[2] = {lines ? slow_count : fast_count, fast_count};
    if (set.rank > 0 &&
        H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, from, nullptr, count, nullptr) < 0)
      return false;
    const hsize_t rows = set.rank == 0 ? 1 : set.rank == 2 ? count[0] * count[1] : count[0];
    const Hdf5Handle memory(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const auto read_into = [&](void* to) {
      return H5Dread(set.set.id(), set.memory(), memory.id(), space.id(), H5P_DEFAULT, to) >= 0;
    };
    const bool all = set.width == 1 || fast_count == set.width;
    if (all && !set.bits) return read_into(out);
    std::vector<double> whole(set.bits ? 0 : rows * set.width);
    std::vector<std::uint8_t> bits(set.bits ? rows * set.width : 0);
    if (!read_into(set.bits ? static_cast<void*>(bits.data()) : whole.data())) return false;
    if (set.bits) whole.assign(bits.begin(), bits.end());
    if (all) {
      std::ranges::copy(whole, out);
      return true;
    }
    for (std::uint64_t row = 0; row < rows; ++row)
      std::copy_n(whole.data() + row * set.width + fast_first, fast_count, out + row * fast_count);
    return true;
  }

  bool read_all(std::size_t variable, std::vector<std::complex<double>>& out) override {
    const Hdf5Silence silence;
    const Variable& v = variables_[variable];
    const Set& set = sets_[variable];
    const std::uint64_t count = count_of(v);
    if (!set.set.ok() || set.member.ok() != v.is_complex || count > most_in_memory ||
        count > believable_numbers(set.set.id()))
      return false;
    const Hdf5Handle space(H5Dget_space(set.set.id()), H5Sclose);
    if (H5Sget_simple_extent_npoints(space.id()) != static_cast<hssize_t>(count)) return false;
    out.resize(count);
    if (v.is_complex)  // pairs of doubles, as std::complex has them
      return H5Dread(set.set.id(), set.memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) >= 0;
    std::vector<double> real(count);
    if (set.bits ||
        H5Dread(set.set.id(), set.memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, real.data()) < 0)
      return false;
    std::ranges::copy(real, out.begin());
    return true;
  }

 private:
  /// Where the numbers of a variable are: a dataset, or a member of one that is a table.
  struct Set {
    Hdf5Handle set{};
    Hdf5Handle member{};     ///< type in memory of the member or of pairs; none: one number each
    int rank{};              ///< of the dataset
    std::uint64_t width{1};  ///< numbers of the member in a row
    bool bits{};             ///< bytes that are no integers (booleans of PyTables)

    [[nodiscard]] hid_t memory() const {
      return member.ok() ? member.id() : bits ? H5T_NATIVE_B8 : H5T_NATIVE_DOUBLE;
    }
  };

  static herr_t collect(hid_t /*group*/, const char* name, const H5L_info_t* /*info*/, void* list) {
    auto& children = *static_cast<std::vector<std::string>*>(list);
    children.emplace_back(name);
    return children.size() > most_variables ? 1 : 0;
  }

  /// What the header of a record has in attributes.
  void take_attributes(hid_t root) {
    for (const char* name : {"format", checksum_name, "title", "date"})
      if (const auto text = read_text_attribute(root, name))
        add({.name = name, .kind = VariableKind::text, .text = *text}, {});
    for (const char* name : {"format_version", "sample_rate_hz", "start_s", "repeat"})
      if (const auto number = read_number_attribute(root, name))
        add({.name = name, .number = *number}, {});
    take_rates(root, "");
  }

  /// Rates that stand beside the samples as attributes.
  void take_rates(hid_t object, const std::string& prefix) {
    for (const char* name :
         {"fs", "Fs", "dt", "sample_rate", "samplerate", "SampleRate", "sampling_rate",
          "SamplingRate", "sampling_frequency", "sample_frequency", "SampleFrequency"})
      if (const auto number = read_number_attribute(object, name))
        add({.name = prefix + name, .number = *number}, {});
  }

  void take_group(hid_t group, const std::string& prefix, int depth) {
    std::vector<std::string> children;
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &children) < 0)
      notes_->add(fmt::format("the group '{}' cannot be read: the file is damaged there",
                              base::printable(prefix.empty() ? "/" : prefix)));
    for (const std::string& child : children) {
      if (child == "#refs#" || child == "#subsystem#" || child.starts_with("_i_"))
        continue;  // what MATLAB keeps for itself, and the indices of PyTables
      const std::string name = prefix + clean_text(child);
      H5O_info_t info{};
      H5L_info_t link{};
      if (H5Lget_info(group, child.c_str(), &link, links_.id()) < 0) {
        left_out(name, "cannot be opened");
      } else if (link.type != H5L_TYPE_HARD && link.type != H5L_TYPE_SOFT) {
        left_out(name, "is a link to another file");
      } else if (H5Oget_info_by_name2(group, child.c_str(), &info, H5O_INFO_BASIC, links_.id()) <
                 0) {
        left_out(name, "cannot be opened");
      } else if (info.type == H5O_TYPE_GROUP && depth < deepest_group) {
        if (!groups_.insert(info.addr).second) continue;  // links can make a circle
        const Hdf5Handle inner(
            H5Gopen2(group, child.c_str(), within_this_file(H5P_GROUP_ACCESS).id()), H5Gclose);
        if (!inner.ok()) continue;
        take_rates(inner.id(), name + '/');
        take_group(inner.id(), name + '/', depth + 1);
      } else if (info.type == H5O_TYPE_DATASET && variables_.size() < most_variables) {
        take_set(open_set(group, child, name), name);
      }
    }
  }

  /// With room in memory for the chunks that it is read from, or each block of samples would unpack
  /// them anew. None where it is not read, which is noted.
  Hdf5Handle open_set(hid_t group, const std::string& child, const std::string& name) {
    const Hdf5Handle access = within_this_file(H5P_DATASET_ACCESS);
    Hdf5Handle set(H5Dopen2(group, child.c_str(), access.id()), H5Dclose);
    std::string why = set.ok() ? why_not_read(set.id()) : "cannot be opened";
    const std::uint64_t one = why.empty() ? chunk_bytes(set.id()) : 0,
                        needed = why.empty() ? working_set(set.id()) : 0;
    constexpr std::uint64_t default_cache = 1U << 20U;
    if (one > most_chunk_bytes)
      why = fmt::format("has chunks larger than {} MiB", most_chunk_bytes >> 20U);
    else if (needed > default_cache && needed > caches_left_)
      why = fmt::format(
          "has chunks of {} MiB, too large to be read beside the others ({} MiB for all; h5repack "
          "-l CHUNK=SIZE makes smaller ones)",
          one >> 20U, most_cache_bytes >> 20U);
    if (!why.empty()) {
      left_out(name, why);
      return {};
    }
    if (needed <= default_cache) return set;
    caches_left_ -= needed;
    const std::size_t slots = 10 * (needed / std::max<std::uint64_t>(one, 1)) + 521;
    H5Pset_chunk_cache(access.id(), slots, needed, H5D_CHUNK_CACHE_W0_DEFAULT);
    set.reset();  // what is open already keeps its cache
    set = {H5Dopen2(group, child.c_str(), access.id()), H5Dclose};
    if (!set.ok()) left_out(name, "cannot be opened");
    return set;
  }

  void left_out(const std::string& name, const std::string& why, const char* kind = "") {
    notes_->add(fmt::format("'{}' {}: left out", base::printable(name), why), 0, 0, kind);
  }

  void add(Variable variable, Set set) {
    variables_.push_back(std::move(variable));
    sets_.push_back(std::move(set));
  }

  void take_set(Hdf5Handle set, const std::string& name) {
    if (!set.ok()) return;
    const std::string matlab = read_text_attribute(set.id(), "MATLAB_class").value_or("");
    if (!matlab.empty()) format_ = RecordFormat::mat73;
    const Hdf5Handle type(H5Dget_type(set.id()), H5Tclose);
    const H5T_class_t kind = H5Tget_class(type.id());
    if (matlab == "char") {
      add({.name = name, .kind = VariableKind::text, .text = matlab_text(set.id())}, {});
    } else if (matlab == "cell" || kind == H5T_REFERENCE) {
      take_cell(set.id(), name);
    } else if (kind == H5T_STRING) {
      take_strings(set.id(), name);
    } else if (is_numeric(type.id())) {
      take_rates(set.id(), name + '/');
      take_numbers(std::move(set), name);
    } else if (kind == H5T_COMPOUND && is_complex(type.id())) {
      take_complex(std::move(set), type.id(), name);
    } else if (kind == H5T_COMPOUND) {
      take_rates(set.id(), name + '/');
      take_table(set, type, name);
    } else {
      left_out(name, "holds neither numbers nor texts", "kind");
    }
  }

  static std::uint64_t count_of(const Variable& v) {
    std::uint64_t count = 1;
    for (const std::uint64_t size : v.sizes)
      count = size == 0 || count <= most_in_memory / size ? count * size : most_in_memory + 1;
    return count;
  }

  void take_complex(Hdf5Handle set, hid_t type, const std::string& name) {
    Variable v{.name = name, .kind = VariableKind::array};
    v.sizes = sizes_of(set.id());
    v.is_complex = true;
    v.unit = unit_of(set.id());
    Hdf5Handle pair(H5Tcreate(H5T_COMPOUND, 2 * sizeof(double)), H5Tclose);
    for (unsigned k = 0; k < 2; ++k) {
      char* member = H5Tget_member_name(type, k);
      const bool inserted =
          H5Tinsert(pair.id(), member, k * sizeof(double), H5T_NATIVE_DOUBLE) >= 0;
      H5free_memory(member);
      if (!inserted) return left_out(name, "cannot be opened");
    }
    const int rank = static_cast<int>(v.sizes.size());
    add(std::move(v), {.set = std::move(set), .member = std::move(pair), .rank = rank});
  }

  /// A table: every member is a variable.
  void take_table(const Hdf5Handle& set, const Hdf5Handle& type, const std::string& name) {
    const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    hsize_t rows = 1;
    if (rank < 0 || rank > 1 || H5Sget_simple_extent_dims(space.id(), &rows, nullptr) < 0)
      return left_out(name, fmt::format("is a table of {} dimensions", rank));
    constexpr hsize_t most = hsize_t{1} << 40U;
    if (rows > most) return left_out(name, "has dimensions beyond any file");
    if (rank == 1) {
      const std::uint64_t held = believable_rows(set.id(), rows, 1);
      if (held < rows)
        notes_->add(fmt::format("'{}' declares {} lines, but the file holds {} at most",
                                base::printable(name), rows, held));
      rows = std::min<hsize_t>(rows, held);
    }
    if (rows > most_packed(set.id(), file_bytes_))
      return left_out(name, fmt::format("declares {} rows, which {} bytes of a file cannot hold",
                                        rows, file_bytes_));
    for (int k = 0; k < H5Tget_nmembers(type.id()); ++k)
      take_member(set, type.id(), static_cast<unsigned>(k), rank, rows, name);
  }

  void take_member(const Hdf5Handle& set, hid_t table, unsigned number, int rank, hsize_t rows,
                   const std::string& table_name) {
    const std::string field = member_name(table, number);
    if (field == "index" && read_text_attribute(set.id(), "index_kind") == counts_rows) return;
    const std::string name = table_name + '/' + field;
    const Hdf5Handle type(H5Tget_member_type(table, number), H5Tclose);
    Hdf5Handle item(H5Tcopy(type.id()), H5Tclose);
    hsize_t width = 1;
    if (H5Tget_class(type.id()) == H5T_ARRAY) {
      if (H5Tget_array_ndims(type.id()) != 1 || H5Tget_array_dims2(type.id(), &width) < 0)
        return left_out(name, "holds arrays of several dimensions");
      item = Hdf5Handle(H5Tget_super(type.id()), H5Tclose);
    }
    constexpr hsize_t widest = 100'000;
    if (is_complex(item.id())) return left_out(name, complex_words, "complex");
    if (!is_numeric(item.id()) || width == 0 || width > widest)
      return left_out(name, "holds no numbers", "kind");
    Set made{.rank = rank, .width = width};
    made.bits = H5Tget_class(item.id()) == H5T_BITFIELD;
    const hid_t number_type = made.bits ? H5T_NATIVE_B8 : H5T_NATIVE_DOUBLE;
    const bool list = H5Tget_class(type.id()) == H5T_ARRAY;
    const Hdf5Handle in_memory =
        list ? Hdf5Handle(H5Tarray_create2(number_type, 1, &width), H5Tclose)
             : Hdf5Handle(H5Tcopy(number_type), H5Tclose);
    made.member = Hdf5Handle(H5Tcreate(H5T_COMPOUND, H5Tget_size(in_memory.id())), H5Tclose);
    char* own_name = H5Tget_member_name(table, number);
    const bool inserted = H5Tinsert(made.member.id(), own_name, 0, in_memory.id()) >= 0;
    H5free_memory(own_name);
    if (!inserted || H5Iinc_ref(set.id()) < 0) return left_out(name, "cannot be opened");
    made.set = Hdf5Handle(set.id(), H5Dclose);
    Variable v{.name = name, .fast = rows};
    if (width > 1) {
      v.fast = width;
      v.slow = rows;
    }
    name_as_pandas(set.id(), field, v);
    add(std::move(v), std::move(made));
  }

  /// Tables of pandas say which member is the index, and what the columns of a block are called.
  void name_as_pandas(hid_t set, const std::string& field, Variable& v) {
    const auto kind = read_text_attribute(set, (field + "_kind").c_str());
    if (!kind) return;
    if (field == "index") return name_index(*kind, v);
    std::vector<std::string> names = pickled_texts(*kind);
    const std::size_t columns = v.slow == 1 ? 1 : v.fast;
    if (names.size() != columns) return;
    Variable items{.name = v.name + "_items", .kind = VariableKind::texts};
    items.texts = std::move(names);
    add(std::move(items), {});
    v.name += "_values";
    counts_nanoseconds(read_text_attribute(set, (field + "_dtype").c_str()), v);
  }

  /// An index counts seconds, nanoseconds or rows.
  static constexpr const char* counts_rows = "integer";
  static void name_index(const std::string& kind, Variable& v) {
    const std::size_t at = v.name.rfind('/');
    v.name = (at == v.name.npos ? "" : v.name.substr(0, at + 1)) + "time";
    counts_nanoseconds(kind, v);
  }

  /// So pandas keeps points in time and distances between them.
  static void counts_nanoseconds(const std::optional<std::string>& kind, Variable& v) {
    if (kind && (kind->starts_with("datetime64") || kind->starts_with("timedelta64")))
      v.unit = "ns";
  }

  /// The texts of a list as Python pickles it (protocol 0).
  static std::vector<std::string> pickled_texts(const std::string& pickle) {
    std::vector<std::string> texts;
    for (const std::string& line : base::split(pickle, "\n")) {
      const std::size_t begin = line.starts_with("aV") ? 2 : line.starts_with('V') ? 1 : 0;
      if (begin > 0) texts.push_back(clean_text(line.substr(begin)));
    }
    return texts;
  }

  void take_numbers(Hdf5Handle set, const std::string& name) {
    const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    hsize_t size[2] = {1, 1};
    if (rank > 2) {
      Variable v{.name = name, .kind = VariableKind::array};
      v.sizes = sizes_of(set.id());
      return add(std::move(v), {.set = std::move(set), .rank = rank});
    }
    if (rank < 0 || H5Sget_simple_extent_dims(space.id(), size, nullptr) < 0)
      return left_out(name, fmt::format("has {} dimensions", rank));
    if (read_number_attribute(set.id(), "MATLAB_empty").value_or(0.0) != 0.0) size[0] = 0;
    Variable v{.name = name};
    v.slow = rank == 2 ? size[0] : 1;
    v.fast = rank == 2 ? size[1] : size[0];
    constexpr hsize_t most = hsize_t{1} << 48U;
    if (v.slow > most || v.fast > most || (v.fast > 0 && v.slow > most / v.fast))
      return left_out(name, "has dimensions beyond any file");
    if (!limit(set.id(), rank, v)) return;
    v.sizes = {v.fast, v.slow};
    v.unit = unit_of(set.id());
    v.texts = read_texts_attribute(set.id(), "units");
    if (const std::string scale = scale_attribute(set.id()); !scale.empty())
      notes_->add(
          fmt::format("'{}' has the attribute {}, which is not used: its numbers are read "
                      "as they stand",
                      base::printable(name), scale));
    if (const auto kind = read_text_attribute(set.id(), "kind"); kind && name.ends_with("/axis1")) {
      if (*kind == counts_rows) return;
      name_index(*kind, v);
    }
    counts_nanoseconds(read_text_attribute(set.id(), "value_type"), v);
    const Hdf5Handle type(H5Dget_type(set.id()), H5Tclose);
    const bool bits = H5Tget_class(type.id()) == H5T_BITFIELD;
    add(std::move(v), {.set = std::move(set), .rank = rank, .bits = bits});
    Variable& added = variables_.back();
    if (added.fast * added.slow == 1 && !read(variables_.size() - 1, 0, 1, 0, 1, &added.number))
      notes_->add(fmt::format("'{}' cannot be read", base::printable(name)));
  }

  /// No more than there is in the file; false where nobody could tell what is.
  bool limit(hid_t set, int rank, Variable& v) {
    if (rank == 0 || v.fast * v.slow <= 1) return true;
    std::uint64_t& lines = rank == 2 ? v.slow : v.fast;
    const std::uint64_t declared = lines;
    lines = std::min(lines, believable_rows(set, lines, rank == 2 ? v.fast : 1));
    if (v.fast * v.slow > most_packed(set, file_bytes_)) {
      left_out(v.name, fmt::format("declares {} numbers, which {} bytes of a file cannot hold",
                                   v.fast * v.slow, file_bytes_));
      return false;
    }
    if (lines == declared) return true;
    notes_->add(fmt::format("'{}' declares {} lines, but the file holds {} at most",
                            base::printable(v.name), declared, lines));
    v.declared = declared;
    return true;
  }

  /// Characters as 16-bit numbers.
  [[nodiscard]] std::string matlab_text(hid_t set) const {
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    const Hdf5Handle type(H5Dget_type(set), H5Tclose);
    const bool empty = read_number_attribute(set, "MATLAB_empty").value_or(0.0) != 0.0;
    if (empty || count < 1 || H5Tget_class(type.id()) != H5T_INTEGER) return "";
    const auto n = static_cast<std::uint64_t>(count);
    if (n > longest_text || n > most_packed(set, file_bytes_)) return "";
    std::vector<std::uint32_t> units(n);
    if (H5Dread(set, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, units.data()) < 0) return "";
    return utf8_from(units);
  }

  void take_strings(hid_t set, const std::string& name) {
    const auto texts = read_texts(set, std::min<std::uint64_t>(longest_text, file_bytes_));
    if (!texts)
      return notes_->add(fmt::format("the texts of '{}' cannot be read", base::printable(name)));
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    Variable v{.name = name, .kind = VariableKind::texts, .texts = *texts};
    if (H5Sget_simple_extent_ndims(space.id()) == 0) {
      v.kind = VariableKind::text;
      v.text = texts->front();
    }
    add(std::move(v), {});
  }

  /// References to texts.
  void take_cell(hid_t set, const std::string& name) {
    const Hdf5Handle type(H5Dget_type(set), H5Tclose);
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    if (H5Tequal(type.id(), H5T_STD_REF_OBJ) <= 0 || count < 1 ||
        static_cast<std::uint64_t>(count) > file_bytes_ / sizeof(hobj_ref_t))
      return left_out(name, "is no list of texts");
    std::vector<hobj_ref_t> references(static_cast<std::size_t>(count));
    if (H5Dread(set, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data()) < 0) return;
    Variable v{.name = name, .kind = VariableKind::texts};
    for (const hobj_ref_t& reference : references) {
      H5O_type_t target{};
      const bool known = H5Rget_obj_type2(set, H5R_OBJECT, &reference, &target) >= 0;
      if (!known || target != H5O_TYPE_DATASET) return left_out(name, "is no list of texts");
      const Hdf5Handle item(H5Rdereference2(set, H5P_DEFAULT, H5R_OBJECT, &reference), H5Dclose);
      if (!item.ok() || !why_not_read(item.id()).empty() ||
          read_text_attribute(item.id(), "MATLAB_class") != "char")
        return left_out(name, "is no list of texts");
      v.texts.push_back(matlab_text(item.id()));
    }
    add(std::move(v), {});
  }

  std::uint64_t file_bytes_;
  Hdf5Handle file_;
  Hdf5Handle links_{within_this_file(H5P_LINK_ACCESS)};
  Notes* notes_{};
  std::vector<Set> sets_;
  std::set<haddr_t> groups_;  ///< that were entered
  std::uint64_t caches_left_{most_cache_bytes};
};

}  // namespace

std::unique_ptr<VariableFile> open_hdf5_here(const std::string& path, Notes& notes) {
  const Hdf5Silence silence;
  return std::make_unique<Hdf5Variables>(open_to_read(path), std::filesystem::file_size(path),
                                         notes);
}

std::unique_ptr<VariableFile> hdf5_variables(hid_t file, std::uint64_t bytes, Notes& notes) {
  H5Iinc_ref(file);
  return std::make_unique<Hdf5Variables>(Hdf5Handle(file, H5Fclose), bytes, notes);
}

}  // namespace hydrapod::data
