/// HDF5 files of other programs and MATLAB 7.3 files as named arrays.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "channel_units.hpp"
#include "hdf5_text.hpp"
#include "hydrapod/base/text.hpp"
#include "unicode.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

constexpr int deepest_group = 6;
constexpr std::size_t most_variables = 20'000;

class Hdf5Variables final : public VariableFile {
 public:
  Hdf5Variables(const std::string& path, Notes& notes)
      : file_bytes_(std::filesystem::file_size(path)),
        file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
    if (!file_.ok()) notes.fail("the HDF5 file is damaged or cut off: it cannot be opened");
    const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    notes_ = &notes;
    take_attributes(root.id());
    take_group(root.id(), "", 0);
    notes_ = nullptr;
  }

  bool read(std::size_t variable, std::uint64_t slow_first, std::uint64_t slow_count,
            std::uint64_t fast_first, std::uint64_t fast_count, double* out) override {
    const Hdf5Silence silence;
    if (slow_count == 0 || fast_count == 0) return true;
    const hid_t set = sets_[variable].id();
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    const hsize_t from[2] = {rank == 2 ? slow_first : fast_first, fast_first};
    const hsize_t count[2] = {rank == 2 ? slow_count : fast_count, fast_count};
    const hsize_t all = slow_count * fast_count;
    const Hdf5Handle memory(H5Screate_simple(1, &all, nullptr), H5Sclose);
    if (rank > 0 &&
        H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, from, nullptr, count, nullptr) < 0)
      return false;
    return H5Dread(set, H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, out) >= 0;
  }

 private:
  static herr_t collect(hid_t /*group*/, const char* name, const H5L_info_t* /*info*/, void* list) {
    auto& children = *static_cast<std::vector<std::string>*>(list);
    children.emplace_back(name);
    return children.size() > most_variables ? 1 : 0;
  }

  /// What the header of a record has in attributes.
  void take_attributes(hid_t root) {
    for (const char* name : {"format", "title", "date"})
      if (const auto text = read_text_attribute(root, name))
        add({.name = name, .kind = VariableKind::text, .text = *text}, {});
    for (const char* name : {"format_version", "sample_rate_hz", "start_s", "repeat"})
      if (const auto number = read_number_attribute(root, name))
        add({.name = name, .number = *number}, {});
  }

  void take_group(hid_t group, const std::string& prefix, int depth) {
    std::vector<std::string> children;
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &children) < 0)
      notes_->add(fmt::format("the group '{}' cannot be read: the file is damaged there",
                              base::printable(prefix.empty() ? "/" : prefix)));
    for (const std::string& child : children) {
      if (child == "#refs#" || child == "#subsystem#") continue;
      const std::string name = prefix + clean_text(child);
      H5O_info_t info{};
      if (H5Oget_info_by_name(group, child.c_str(), &info, H5P_DEFAULT) < 0) {
        left_out(name, "cannot be opened");
      } else if (info.type == H5O_TYPE_GROUP && depth < deepest_group) {
        const Hdf5Handle inner(H5Gopen2(group, child.c_str(), H5P_DEFAULT), H5Gclose);
        if (inner.ok()) take_group(inner.id(), name + '/', depth + 1);
      } else if (info.type == H5O_TYPE_DATASET && variables_.size() < most_variables) {
        take_set({H5Dopen2(group, child.c_str(), H5P_DEFAULT), H5Dclose}, name);
      }
    }
  }

  void left_out(const std::string& name, const std::string& why, const char* kind = "") {
    notes_->add(fmt::format("'{}' {}: left out", base::printable(name), why), 0, 0, kind);
  }

  void add(Variable variable, Hdf5Handle set) {
    variables_.push_back(std::move(variable));
    sets_.push_back(std::move(set));
  }

  void take_set(Hdf5Handle set, const std::string& name) {
    if (!set.ok()) return left_out(name, "cannot be opened");
    const std::string matlab = read_text_attribute(set.id(), "MATLAB_class").value_or("");
    if (!matlab.empty()) format_ = RecordFormat::mat73;
    if (chunk_bytes(set.id()) > most_chunk_bytes)
      return left_out(name, fmt::format("has chunks larger than {} MiB", most_chunk_bytes >> 20U));
    const Hdf5Handle type(H5Dget_type(set.id()), H5Tclose);
    const H5T_class_t kind = H5Tget_class(type.id());
    if (matlab == "char") {
      add({.name = name, .kind = VariableKind::text, .text = matlab_text(set.id())}, {});
    } else if (matlab == "cell" || kind == H5T_REFERENCE) {
      take_cell(set.id(), name);
    } else if (kind == H5T_STRING) {
      take_strings(set.id(), name);
    } else if (kind == H5T_FLOAT || kind == H5T_INTEGER) {
      take_numbers(std::move(set), name);
    } else {
      left_out(name, "holds neither numbers nor texts", "kind");
    }
  }

  void take_numbers(Hdf5Handle set, const std::string& name) {
    const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.id());
    hsize_t size[2] = {1, 1};
    if (rank < 0 || rank > 2 || H5Sget_simple_extent_dims(space.id(), size, nullptr) < 0)
      return left_out(name, fmt::format("has {} dimensions", rank));
    if (read_number_attribute(set.id(), "MATLAB_empty").value_or(0.0) != 0.0) size[0] = 0;
    Variable v{.name = name};
    v.slow = rank == 2 ? size[0] : 1;
    v.fast = rank == 2 ? size[1] : size[0];
    constexpr hsize_t most = hsize_t{1} << 48U;
    if (v.slow > most || v.fast > most || (v.fast > 0 && v.slow > most / v.fast))
      return left_out(name, "has dimensions beyond any file");
    limit(set.id(), rank, v);
    v.unit = read_text_attribute(set.id(), "unit")
                 .value_or(read_text_attribute(set.id(), "units").value_or(""));
    add(std::move(v), std::move(set));
    Variable& added = variables_.back();
    if (added.fast * added.slow == 1 && !read(variables_.size() - 1, 0, 1, 0, 1, &added.number))
      notes_->add(fmt::format("'{}' cannot be read", base::printable(name)));
  }

  /// No more than there is in the file.
  void limit(hid_t set, int rank, Variable& v) {
    if (rank == 0 || v.fast * v.slow <= 1) return;
    const std::uint64_t declared = rank == 2 ? v.slow : v.fast;
    const std::uint64_t held = believable_rows(set, declared, rank == 2 ? v.fast : 1);
    if (held >= declared) return;
    notes_->add(fmt::format("'{}' declares {} lines, but the file holds {} at most",
                            base::printable(v.name), declared, held));
    (rank == 2 ? v.slow : v.fast) = held;
  }

  /// Characters as 16-bit numbers.
  [[nodiscard]] std::string matlab_text(hid_t set) const {
    const Hdf5Handle space(H5Dget_space(set), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    const Hdf5Handle type(H5Dget_type(set), H5Tclose);
    const bool empty = read_number_attribute(set, "MATLAB_empty").value_or(0.0) != 0.0;
    if (empty || count < 1 || H5Tget_class(type.id()) != H5T_INTEGER) return "";
    const auto n = static_cast<std::uint64_t>(count);
    if (n > longest_text || n * H5Tget_size(type.id()) > 1100 * file_bytes_) return "";
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
      if (!item.ok() || read_text_attribute(item.id(), "MATLAB_class") != "char")
        return left_out(name, "is no list of texts");
      v.texts.push_back(matlab_text(item.id()));
    }
    add(std::move(v), {});
  }

  std::uint64_t file_bytes_;
  Hdf5Handle file_;
  Notes* notes_{};
  std::vector<Hdf5Handle> sets_;
};

}  // namespace

std::unique_ptr<VariableFile> open_hdf5_variables(const std::string& path, Notes& notes) {
  const Hdf5Silence silence;
  return std::make_unique<Hdf5Variables>(path, notes);
}

}  // namespace hydrapod::data
