/// Frequency responses as arrays of MAT and HDF5 files: what hydrapod writes is read here by matio
/// and by the HDF5 library, and what h5py and MATLAB write is made here with these.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>
#include <memory>
#include <numbers>

#include "hydrapod/data/frequency_response.hpp"
#include "library_files.hpp"
#include "said.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using Complex = std::complex<double>;
using data::FileKind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t lines = 41;

/// A number for every place, none of which is another's.
Complex entry(std::size_t line, std::size_t output, std::size_t input) {
  return {1.0 + 0.37 * static_cast<double>(line) + 100.0 * static_cast<double>(output),
          -0.11 * static_cast<double>(line) + 1000.0 * static_cast<double>(input)};
}
double frequency(std::size_t line) { return 0.75 + 0.3 * static_cast<double>(line); }

std::vector<double> frequencies() {
  std::vector<double> all;
  for (std::size_t k = 0; k < lines; ++k) all.push_back(frequency(k));
  return all;
}

void expect_entries(const data::FrequencyResponses& got, std::size_t outputs, std::size_t inputs,
                    double factor = 1.0) {
  ASSERT_EQ(got.outputs.size(), outputs);
  ASSERT_EQ(got.inputs.size(), inputs);
  ASSERT_EQ(got.lines(), lines);
  for (std::size_t k = 0; k < lines; ++k) {
    EXPECT_DOUBLE_EQ(got.frequency[k], frequency(k));
    for (std::size_t o = 0; o < outputs; ++o)
      for (std::size_t i = 0; i < inputs; ++i)
        EXPECT_LT(std::abs(got.H[k](static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i)) -
                           factor * entry(k, o, i)),
                  1e-12 * std::abs(factor * entry(k, o, i)));
  }
}

data::FrequencyResponses example() {
  data::FrequencyResponses all;
  all.title = "Prüfstand";
  all.date = "2026-11-20T10:00:00";
  all.inputs = {{"F1", "N", data::Direction::x, data::Role::excitation, 1},
                {"M, 2", "N m", data::Direction::ry, data::Role::excitation, 2}};
  all.outputs = {{"a", "m/s^2", data::Direction::x, data::Role::response, 7},
                 {"b/c", "rad", data::Direction::minus_ry, data::Role::response, 7},
                 {"d", "m", data::Direction::none, data::Role::response, 0}};
  all.frequency = frequencies();
  for (std::size_t k = 0; k < lines; ++k) {
    auto& H = all.H.emplace_back(3, 2);
    for (Eigen::Index o = 0; o < 3; ++o)
      for (Eigen::Index i = 0; i < 2; ++i)
        H(o, i) = entry(k, static_cast<std::size_t>(o), static_cast<std::size_t>(i));
    all.multiple_coherence.emplace_back(
        Eigen::Vector3d(0.9, 1.0 / 3.0, 0.001 * static_cast<double>(k)));
    all.noise.emplace_back(Eigen::Vector3cd(1e-3, 2e-4, 0.7).asDiagonal());
    all.input_factor.emplace_back(Eigen::Vector2cd(0.3, 1.7).asDiagonal());
    all.condition.push_back(1.0 + static_cast<double>(k));
  }
  return all;
}

std::string refusal(const std::string& path) {
  return refusal_of([&] { data::read_frequency_responses(path); }).message;
}

// MAT, through matio

matvar_t* mat_complex(const char* name, std::vector<std::size_t> sizes,
                      const std::vector<Complex>& values) {
  std::vector<double> real, imaginary;
  for (const Complex value : values) {
    real.push_back(value.real());
    imaginary.push_back(value.imag());
  }
  mat_complex_split_t split{real.data(), imaginary.data()};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, static_cast<int>(sizes.size()),
                       sizes.data(), &split, MAT_F_COMPLEX);
}
matvar_t* mat_real(const char* name, std::vector<double> values) {
  std::size_t size[2] = {1, values.size()};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0);
}
matvar_t* mat_texts(const char* name, const std::vector<std::string>& texts) {
  std::size_t size[2] = {1, texts.size()};
  matvar_t* cell = Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, size, nullptr, 0);
  for (std::size_t k = 0; k < texts.size(); ++k) {
    std::size_t length[2] = {1, texts[k].size()};
    std::string text = texts[k];
    Mat_VarSetCell(cell, static_cast<int>(k),
                   Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, length, text.data(), 0));
  }
  return cell;
}

/// outputs × inputs × lines as MATLAB has them, the first index fastest.
std::vector<Complex> by_columns(std::size_t outputs, std::size_t inputs) {
  std::vector<Complex> all;
  for (std::size_t k = 0; k < lines; ++k)
    for (std::size_t i = 0; i < inputs; ++i)
      for (std::size_t o = 0; o < outputs; ++o) all.push_back(entry(k, o, i));
  return all;
}

class ResponseArrays : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const char* name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

/// scipy.io.loadmat and MATLAB see an array of complex doubles, outputs × inputs × lines.
TEST_F(ResponseArrays, InMatAreAComplexArrayForMatio) {
  data::write_mat_variables(path("h.mat"), data::response_arrays(example()));
  const std::unique_ptr<mat_t, MatClose> file(Mat_Open(path("h.mat").c_str(), MAT_ACC_RDONLY));
  ASSERT_TRUE(file);
  const std::unique_ptr<matvar_t, MatFree> H(Mat_VarRead(file.get(), "response"));
  ASSERT_TRUE(H);
  ASSERT_EQ(H->rank, 3);
  EXPECT_THAT(std::vector(H->dims, H->dims + 3), ElementsAre(3U, 2U, lines));
  ASSERT_TRUE(H->isComplex);
  const auto* split = static_cast<const mat_complex_split_t*>(H->data);
  const std::vector<Complex> expected = by_columns(3, 2);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(static_cast<const double*>(split->Re)[k], expected[k].real());
    EXPECT_EQ(static_cast<const double*>(split->Im)[k], expected[k].imag());
  }
}

struct Pair {
  double r, i;
};
hid_t pair_type(const char* real = "r", const char* imaginary = "i") {
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Pair));
  H5Tinsert(type, real, HOFFSET(Pair, r), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, imaginary, HOFFSET(Pair, i), H5T_NATIVE_DOUBLE);
  return type;
}

/// h5py takes a compound of two floats called r and i for complex128; h5["response"][k] is the
/// matrix of a line.
TEST_F(ResponseArrays, InHdf5AreAComplexArrayForH5py) {
  data::write_hdf5_variables(path("h.h5"), data::response_arrays(example()));
  const hid_t file = H5Fopen(path("h.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t set = H5Dopen2(file, "response", H5P_DEFAULT);
  ASSERT_GE(set, 0);
  const hid_t type = H5Dget_type(set), space = H5Dget_space(set);
  ASSERT_EQ(H5Tget_class(type), H5T_COMPOUND);
  ASSERT_EQ(H5Tget_nmembers(type), 2);
  EXPECT_EQ(H5Tget_member_index(type, "r"), 0);
  EXPECT_EQ(H5Tget_member_index(type, "i"), 1);
  EXPECT_EQ(H5Tget_size(type), 16U);
  hsize_t size[3]{};
  ASSERT_EQ(H5Sget_simple_extent_dims(space, size, nullptr), 3);
  EXPECT_THAT(size, ElementsAre(lines, 3U, 2U));
  std::vector<Pair> all(lines * 6);
  ASSERT_GE(H5Dread(set, pair_type(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), 0);
  for (std::size_t k = 0; k < lines; ++k)
    for (std::size_t o = 0; o < 3; ++o)
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(all[(k * 3 + o) * 2 + i].r, entry(k, o, i).real());
        EXPECT_EQ(all[(k * 3 + o) * 2 + i].i, entry(k, o, i).imag());
      }
  const hid_t list = H5Dopen2(file, "frequency_hz", H5P_DEFAULT);
  std::vector<double> f(lines);
  ASSERT_GE(H5Dread(list, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, f.data()), 0);
  EXPECT_EQ(f, frequencies());
  H5Fclose(file);
}

TEST_F(ResponseArrays, OfHydrapodAreNoRecordAndAreReadBack) {
  data::write_mat_variables(path("h.mat"), data::response_arrays(example()));
  data::write_hdf5_variables(path("h.h5"), data::response_arrays(example()));
  for (const char* name : {"h.mat", "h.h5"}) {
    SCOPED_TRACE(name);
    EXPECT_EQ(data::file_kind(path(name)), FileKind::frequency_responses);
    const auto [got, notes] = data::read_frequency_responses(path(name));
    EXPECT_THAT(messages(notes), IsEmpty());
    expect_entries(got, 3, 2);
    EXPECT_EQ(got.title, "Prüfstand");
    EXPECT_EQ(got.inputs[1].name, "M, 2");
    EXPECT_EQ(got.inputs[1].unit, "N m");
    EXPECT_EQ(got.outputs[1].direction, data::Direction::minus_ry);
    EXPECT_EQ(got.multiple_coherence[7], example().multiple_coherence[7]);
    EXPECT_EQ(got.noise[3], example().noise[3]);
    EXPECT_EQ(got.input_factor[3], example().input_factor[3]);
    EXPECT_THAT(refusal_of([&] { data::read_record(path(name)); }).message,
                HasSubstr("`hydrapod identify` finds their"));
  }
}

TEST_F(ResponseArrays, OfOneLineAreReadBack) {
  auto one = example();
  one.frequency = {3.75};
  one.H = {example().H[2]};
  one.multiple_coherence = {example().multiple_coherence[2]};
  one.noise = {example().noise[2]};
  one.input_factor = {example().input_factor[2]};
  one.condition = {2.5};
  data::write_mat_variables(path("h.mat"), data::response_arrays(one));
  data::write_hdf5_variables(path("h.h5"), data::response_arrays(one));
  for (const char* name : {"h.mat", "h.h5"}) {
    const auto got = data::read_frequency_responses(path(name)).responses;
    EXPECT_EQ(got.frequency, one.frequency) << name;
    EXPECT_EQ(got.H[0], one.H[0]) << name;
  }
}

TEST_F(ResponseArrays, AtFrequenciesThatDoNotAscendAreRefused) {
  for (const double third : {std::nan(""), -2.5, frequencies()[0]}) {
    auto all = data::response_arrays(example());
    for (auto& v : all)
      if (v.name == "frequency_hz") v.real[2] = third;
    data::write_mat_variables(path("h.mat"), all);
    data::write_hdf5_variables(path("h.h5"), all);
    for (const char* name : {"h.mat", "h.h5"})
      EXPECT_THAT(refusal(path(name)), HasSubstr("do not ascend from 0 Hz on: number 3 is"));
  }
}

TEST_F(ResponseArrays, EqualResponsesAreEqualFiles) {
  for (const char* name : {"a.h5", "b.h5"})
    data::write_hdf5_variables(path(name), data::response_arrays(example()));
  EXPECT_EQ(read_text(path("a.h5")), read_text(path("b.h5")));
}

/// Another program kept the arrays and dropped the text: names and units are beside them.
TEST_F(ResponseArrays, WithoutTheDescriptionHaveTheirNamesAndUnits) {
  auto all = data::response_arrays(example());
  std::erase_if(all, [](const auto& v) { return v.name == "description" || v.name == "noise"; });
  data::write_mat_variables(path("h.mat"), all);
  const auto [got, notes] = data::read_frequency_responses(path("h.mat"));
  expect_entries(got, 3, 2);
  EXPECT_EQ(got.outputs[0].unit, "m/s^2");
  EXPECT_EQ(got.inputs[1].name, "M, 2");
  EXPECT_NEAR(got.variance(4, 2, 1), 0.7 * 1.7, 0.5);  // from the deviations, by their means
}

// files of other programs

TEST_F(ResponseArrays, OfMatlabCountOutputsFirst) {
  for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    write_mat(path("m.mat"),
              {mat_real("freq", frequencies()), mat_complex("FRF", {3, 2, lines}, by_columns(3, 2)),
               mat_real("fs", {512.0})},
              compression);
    EXPECT_EQ(data::file_kind(path("m.mat")), FileKind::frequency_responses);
    const auto [got, notes] = data::read_frequency_responses(path("m.mat"));
    expect_entries(got, 3, 2);
    EXPECT_THAT(messages(notes),
                ElementsAre("'FRF' (3 × 2 × 41): 3 outputs, 2 inputs, 41 frequencies",
                            "the file states no units of the outputs (output_units)",
                            "the file states no units of the inputs (input_units)"));
    EXPECT_EQ(got.outputs[2].name, "output 3");
    EXPECT_EQ(got.inputs[0].role, data::Role::excitation);
  }
}

TEST_F(ResponseArrays, NamesAndUnitsBesideThemAreUsed) {
  write_mat(path("m.mat"),
            {mat_real("f", frequencies()),
             mat_complex("H", {lines, 2},
                         [] {
                           std::vector<Complex> all;
                           for (std::size_t o = 0; o < 2; ++o)
                             for (std::size_t k = 0; k < lines; ++k) all.push_back(entry(k, o, 0));
                           return all;
                         }()),
             mat_texts("output_names", {"a1", "a2"}), mat_texts("output_units", {"g", "g"}),
             mat_texts("input_units", {"kN"})});
  const auto [got, notes] = data::read_frequency_responses(path("m.mat"));
  expect_entries(got, 2, 1, 9.80665 / 1000.0);
  EXPECT_EQ(got.outputs[1].name, "a2");
  EXPECT_EQ(got.outputs[1].unit, "m/s^2");
  EXPECT_EQ(got.inputs[0].unit, "N");
}

/// A hammer that roves: names say that the columns are inputs.
TEST_F(ResponseArrays, ColumnsAreInputsWhereTheirNamesSaySo) {
  std::vector<Complex> all;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < lines; ++k) all.push_back(entry(k, 0, i));
  write_mat(path("m.mat"), {mat_real("f", frequencies()), mat_complex("H", {lines, 3}, all),
                            mat_texts("inputs", {"hit 1", "hit 2", "hit 3"})});
  expect_entries(data::read_frequency_responses(path("m.mat")).responses, 1, 3);
}

/// lines × outputs × inputs as numpy has them, the last index fastest.
std::vector<Pair> by_rows(std::size_t outputs, std::size_t inputs) {
  std::vector<Pair> all;
  for (std::size_t k = 0; k < lines; ++k)
    for (std::size_t o = 0; o < outputs; ++o)
      for (std::size_t i = 0; i < inputs; ++i)
        all.push_back({entry(k, o, i).real(), entry(k, o, i).imag()});
  return all;
}

TEST_F(ResponseArrays, OfH5pyAreReadWithFrequenciesInRadiansPerSecond) {
  std::vector<double> omega = frequencies();
  for (double& w : omega) w *= 2.0 * std::numbers::pi;
  {
    Hdf5File file(path("h.h5"));
    file.write("omega", H5T_NATIVE_DOUBLE, {lines}, omega.data());
    file.write("H", pair_type(), {lines, 2, 3}, by_rows(2, 3).data());
    file.write("coh", H5T_NATIVE_DOUBLE, {lines}, omega.data());
  }
  EXPECT_EQ(data::file_kind(path("h.h5")), FileKind::frequency_responses);
  expect_entries(data::read_frequency_responses(path("h.h5")).responses, 2, 3);
}

TEST_F(ResponseArrays, OfFloatsAndOfKilohertzAreRead) {
  std::vector<double> kilohertz = frequencies();
  for (double& f : kilohertz) f /= 1000.0;
  struct Floats {
    float r, i;
  };
  std::vector<Floats> halves;
  for (const Pair& p : by_rows(1, 1)) halves.push_back({float(0.5 * p.r), float(0.5 * p.i)});
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Floats));
  H5Tinsert(type, "real", HOFFSET(Floats, r), H5T_NATIVE_FLOAT);
  H5Tinsert(type, "imag", HOFFSET(Floats, i), H5T_NATIVE_FLOAT);
  {
    Hdf5File file(path("h.h5"));
    file.write("frequency", H5T_NATIVE_DOUBLE, {lines}, kilohertz.data());
    file.attribute("frequency", "units", "kHz");
    file.write("frf", type, {lines}, halves.data());
  }
  const auto got = data::read_frequency_responses(path("h.h5")).responses;
  ASSERT_EQ(got.lines(), lines);
  EXPECT_DOUBLE_EQ(got.frequency[5], frequency(5));
  EXPECT_NEAR(got.H[5](0, 0).imag(), 0.5 * entry(5, 0, 0).imag(), 1e-7);
}

/// Real and imaginary part as two arrays.
TEST_F(ResponseArrays, OfTwoRealArraysAreRead) {
  std::vector<double> real, imaginary;
  for (const Pair& p : by_rows(2, 1)) {
    real.push_back(p.r);
    imaginary.push_back(p.i);
  }
  {
    Hdf5File file(path("h.h5"));
    file.write("f", H5T_NATIVE_DOUBLE, {lines}, frequencies().data());
    file.write("H_real", H5T_NATIVE_DOUBLE, {lines, 2}, real.data());
    file.write("H_imag", H5T_NATIVE_DOUBLE, {lines, 2}, imaginary.data());
  }
  expect_entries(data::read_frequency_responses(path("h.h5")).responses, 2, 1);
}

TEST_F(ResponseArrays, ThatAreListsAreOutputs) {
  {
    Hdf5File file(path("h.h5"));
    file.write("f", H5T_NATIVE_DOUBLE, {lines}, frequencies().data());
    file.write("a1", pair_type(), {lines}, by_rows(1, 1).data());
    auto second = by_rows(1, 1);
    for (Pair& p : second) p.r += 100.0;
    file.write("a2", pair_type(), {lines}, second.data());
  }
  const auto [got, notes] = data::read_frequency_responses(path("h.h5"));
  expect_entries(got, 2, 1);
  EXPECT_THAT(messages(notes),
              testing::Contains("each list is taken as the response of one output to one input: "
                                "a1, a2"));
  EXPECT_EQ(got.outputs[1].name, "a2");
}

TEST_F(ResponseArrays, ThatCanBeUnderstoodInTwoWaysAreRefused) {
  {
    Hdf5File file(path("two.h5"));
    file.write("f", H5T_NATIVE_DOUBLE, {lines}, frequencies().data());
    file.write("A", pair_type(), {lines, 2, 3}, by_rows(2, 3).data());
    file.write("B", pair_type(), {lines, 3, 2}, by_rows(2, 3).data());
  }
  EXPECT_EQ(refusal(path("two.h5")),
            "several arrays may be the responses: 'A' (41 × 2 × 3), 'B' (41 × 3 × 2); keep one in "
            "the file, or call it H or frf");
  {
    Hdf5File file(path("estimators.h5"));
    file.write("f", H5T_NATIVE_DOUBLE, {lines}, frequencies().data());
    file.write("H1", pair_type(), {lines}, by_rows(1, 1).data());
    file.write("H2", pair_type(), {lines}, by_rows(1, 1).data());
  }
  EXPECT_THAT(refusal(path("estimators.h5")), HasSubstr("several arrays may be the responses"));
  const double three[] = {1.0, 2.0, 4.0};
  {
    Hdf5File file(path("square.h5"));
    file.write("f", H5T_NATIVE_DOUBLE, {3}, three);
    file.write("H", pair_type(), {3, 3}, by_rows(2, 3).data());
  }
  EXPECT_THAT(refusal(path("square.h5")), HasSubstr("which index counts them cannot be told"));
  {
    Hdf5File file(path("lists.h5"));
    file.write("f", H5T_NATIVE_DOUBLE, {lines}, frequencies().data());
    file.write("omega", H5T_NATIVE_DOUBLE, {lines}, frequencies().data());
    file.write("H", pair_type(), {lines}, by_rows(1, 1).data());
  }
  EXPECT_THAT(refusal(path("lists.h5")), HasSubstr("several lists of frequencies"));
}

/// Samples over time with a complex channel and a force called f stay a record.
TEST_F(ResponseArrays, AreNotSeenInRecords) {
  std::vector<double> force;
  for (std::size_t k = 0; k < lines; ++k) force.push_back(std::sin(0.9 * static_cast<double>(k)));
  write_mat(path("m.mat"), {mat_real("f", force), mat_complex("z", {1, lines}, by_columns(1, 1)),
                            mat_real("fs", {100.0})});
  EXPECT_EQ(data::file_kind(path("m.mat")), FileKind::record);
  const auto record = data::read_record(path("m.mat")).record;
  EXPECT_EQ(record.header.sample_rate, 100.0);
  EXPECT_EQ(record.samples(7, 0), force[7]);
}

TEST_F(ResponseArrays, CutOffAreAnErrorNotACrash) {
  data::write_mat_variables(path("h.mat"), data::response_arrays(example()));
  data::write_hdf5_variables(path("h.h5"), data::response_arrays(example()));
  for (const char* name : {"h.mat", "h.h5"}) {
    const std::string whole = read_text(path(name));
    for (std::size_t size = 200; size < whole.size(); size += 997) {
      write_text(path("cut"), whole.substr(0, size));
      try {
        data::file_kind(path("cut"));
        data::read_frequency_responses(path("cut"));
      } catch (const base::InputError&) {
      }
    }
  }
}

TEST_F(ResponseArrays, WithoutImaginaryPartsAreRefused) {
  auto values = by_columns(2, 1);
  for (Complex& value : values) value = value.real();
  write_mat(path("m.mat"), {mat_real("f", frequencies()), mat_complex("H", {2, 1, lines}, values)});
  EXPECT_THAT(refusal(path("m.mat")), HasSubstr("all imaginary parts are 0"));
}

TEST_F(ResponseArrays, FrequenciesPerSecondAreCircularWhereTheyAreCalledOmega) {
  std::vector<double> omega = frequencies();
  for (double& w : omega) w *= 2.0 * std::numbers::pi;
  for (const char* name : {"omega", "f"}) {
    {
      Hdf5File file(path("h.h5"));
      file.write(name, H5T_NATIVE_DOUBLE, {lines}, omega.data());
      file.attribute(name, "unit", std::string("1/s"));
      file.write("H", pair_type(), {lines, 2, 3}, by_rows(2, 3).data());
    }
    if (name[0] == 'o')
      expect_entries(data::read_frequency_responses(path("h.h5")).responses, 2, 3);
    else
      EXPECT_THAT(refusal(path("h.h5")), HasSubstr("may mean Hz or rad/s"));
  }
}

TEST_F(ResponseArrays, PoundsOfInputsAreForces) {
  write_mat(path("m.mat"),
            {mat_real("f", frequencies()), mat_complex("H", {2, 1, lines}, by_columns(2, 1)),
             mat_texts("output_units", {"m", "m"}), mat_texts("input_units", {"lb"})});
  const auto [got, notes] = data::read_frequency_responses(path("m.mat"));
  expect_entries(got, 2, 1, 1.0 / 4.4482216152605);
  EXPECT_EQ(got.inputs[0].unit, "N");
  EXPECT_THAT(messages(notes),
              testing::Contains(HasSubstr("\"lb\" is taken for lbf, pounds of force")));
}

}  // namespace
}  // namespace hydrapod::test
