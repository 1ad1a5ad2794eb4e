#pragma once
/// Files that matio and the HDF5 library write, which other programs use; the writers of hydrapod
/// have no part in them.

#include <gtest/gtest.h>
#include <hdf5.h>
#include <matio.h>

#include <memory>
#include <string>
#include <vector>

namespace hydrapod::test {

struct MatClose {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct MatFree {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

/// The variables become the file's.
inline void write_mat(const std::string& path, const std::vector<matvar_t*>& variables,
                      matio_compression compression = MAT_COMPRESSION_NONE) {
  const std::unique_ptr<mat_t, MatClose> file(Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5));
  for (matvar_t* variable : variables) {
    ASSERT_EQ(Mat_VarWrite(file.get(), variable, compression), 0);
    Mat_VarFree(variable);
  }
}

/// An HDF5 file with datasets of its root.
class Hdf5File {
 public:
  explicit Hdf5File(const std::string& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~Hdf5File() { H5Fclose(file_); }
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Without sizes: one value.
  void write(const char* name, hid_t type, const std::vector<hsize_t>& sizes, const void* bytes) {
    const hid_t space =
        sizes.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
    const hid_t set = H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes), 0);
    H5Dclose(set);
    H5Sclose(space);
  }
  void attribute(const char* set, const char* name, const std::string& value) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, value.size());
    attribute(set, name, type, value.data());
    H5Tclose(type);
  }
  void attribute(const char* set, const char* name, double value) {
    attribute(set, name, H5T_NATIVE_DOUBLE, &value);
  }
  [[nodiscard]] hid_t id() const { return file_; }

 private:
  void attribute(const char* set_name, const char* name, hid_t type, const void* bytes) {
    const hid_t set = H5Dopen2(file_, set_name, H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    const hid_t made = H5Acreate2(set, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(made, type, bytes);
    H5Aclose(made);
    H5Sclose(space);
    H5Dclose(set);
  }

  hid_t file_;
};

}  // namespace hydrapod::test
