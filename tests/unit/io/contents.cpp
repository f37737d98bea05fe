// SPDX-License-Identifier: BSD-3-Clause
// HDF5 files as plain values: this process survives any content of a file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <H5Cpp.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <tuple>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "io/hdf5/read_write.hpp"
#include "support/message_of.hpp"

namespace straytrace::io::hdf5 {
namespace {

using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Key;

std::string image(std::function<void(H5::H5File&)> const& fill) {
  H5::FileAccPropList list;
  list.setCore(1 << 16, false);
  H5::H5File file("straytrace-test", H5F_ACC_TRUNC, H5::FileCreatPropList::DEFAULT, list);
  fill(file);
  file.flush(H5F_SCOPE_GLOBAL);
  std::string bytes(std::size_t(H5Fget_file_image(file.getId(), nullptr, 0)), '\0');
  H5Fget_file_image(file.getId(), bytes.data(), bytes.size());
  return bytes;
}

H5::DataSet list(H5::H5File& file, char const* path, H5::DataType const& type, hsize_t count) {
  return file.createDataSet(path, type, H5::DataSpace(1, &count));
}

template <class T>
void write(H5::H5File& file, char const* path, H5::PredType const& type, std::vector<T> const& values) {
  list(file, path, type, values.size()).write(values.data(), type);
}

TEST(Hdf5Contents, NumbersOfEveryTypeBecomeTheNearest) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  Reader const in(image([&](H5::H5File& file) {
    write<std::int8_t>(file, "bytes", H5::PredType::NATIVE_INT8, {-5, 7});
    write<std::uint64_t>(file, "large", H5::PredType::NATIVE_UINT64, {1, ~std::uint64_t{0}});
    write<float>(file, "reals", H5::PredType::NATIVE_FLOAT, {0.5F, 300});
    write<double>(file, "odd", H5::PredType::NATIVE_DOUBLE, {nan, 1e300, -1});
    list(file, "big_endian", H5::PredType::STD_I16BE, 1).write(std::vector<int>{-2}.data(), H5::PredType::NATIVE_INT);
  }));
  EXPECT_THAT(in.array<double>("bytes"), ElementsAre(-5, 7));
  EXPECT_THAT(in.array<std::uint32_t>("/bytes"), ElementsAre(0, 7));
  EXPECT_THAT(in.array<std::uint8_t>("/large"), ElementsAre(1, 255));
  EXPECT_THAT(in.array<std::uint64_t>("/large"), ElementsAre(1, ~std::uint64_t{0}));
  EXPECT_THAT(in.array<double>("/reals"), ElementsAre(0.5, 300));
  EXPECT_THAT(in.array<std::uint8_t>("/reals"), ElementsAre(0, 255));
  EXPECT_THAT(in.array<std::uint32_t>("/odd"), ElementsAre(0, std::numeric_limits<std::uint32_t>::max(), 0));
  EXPECT_THAT(in.array<double>("/big_endian"), ElementsAre(-2));
}

TEST(Hdf5Contents, TextsOfOneAndOfAnyLength) {
  Reader const in(image([](H5::H5File& file) {
    std::vector<char const*> const words{"rho", "", "kappa"};
    list(file, "any", H5::StrType(H5::PredType::C_S1, H5T_VARIABLE), 3)
        .write(words.data(), H5::StrType(H5::PredType::C_S1, H5T_VARIABLE));
    list(file, "one", H5::StrType(H5::PredType::C_S1, 4), 2).write("abcdef\0\0", H5::StrType(H5::PredType::C_S1, 4));
  }));
  EXPECT_THAT(in.strings("/any"), ElementsAre("rho", "", "kappa"));
  EXPECT_THAT(in.strings("/one"), ElementsAre("abcd", "ef"));
  EXPECT_THAT(message_of([&] { (void)in.array<double>("/one"); }), HasSubstr("'/one' is missing or cannot be read"));
}

TEST(Hdf5Contents, AnObjectWithTwoNamesAppearsUnderBoth) {
  Reader const in(image([](H5::H5File& file) {
    file.createGroup("/a");
    write<double>(file, "/a/x", H5::PredType::NATIVE_DOUBLE, {1, 2});
    file.link(H5L_TYPE_HARD, "/a", "/z");
  }));
  EXPECT_EQ(in.array<double>("/z/x"), in.array<double>("/a/x"));
}

// Storage in other files, whole or in pieces: they would be read with the rights of the user.
TEST(Hdf5Contents, OtherFilesAreNotRead) {
  std::string const bytes = image([](H5::H5File& file) {
    hsize_t const count = 8;
    H5::DSetCreatPropList outside, pieces;
    outside.setExternal("/etc/passwd", 0, 8);
    H5::DataSpace const space(1, &count);
    file.createDataSet("outside", H5::PredType::NATIVE_UINT8, space, outside);
    H5Pset_virtual(pieces.getId(), space.getId(), "/etc/passwd", "x", space.getId());
    file.createDataSet("pieces", H5::PredType::NATIVE_UINT8, space, pieces);
  });
  Reader const in(bytes);
  for (char const* path : {"/outside", "/pieces"}) {
    EXPECT_EQ(in.object(path).values.state, State::elsewhere);
    EXPECT_THAT(message_of([&] { (void)in.array<double>(path); }), HasSubstr("keeps its values in other files"));
    EXPECT_THAT(message_of([&] { (void)slab(bytes, path, 0, 8); }), HasSubstr("keeps its values in other files"));
  }
}

// Requested one by one, they would take a time that grows with the square of their number.
TEST(Hdf5Contents, ManyGroupsAndAttributesAreListedOnce) {
  Contents const all = contents_of(image([](H5::H5File& file) {
    H5::Group const many = file.createGroup("many");
    for (int i = 0; i < 20000; ++i) H5::Group(many.createGroup(std::to_string(i)));
    for (int i = 0; i < 500; ++i)
      many.createAttribute(std::to_string(i), H5::PredType::NATIVE_INT8, H5::DataSpace(H5S_SCALAR));
  }));
  EXPECT_EQ(all.size(), 20002u);
  EXPECT_EQ(all.at("/many").attributes.size(), 500u);
}

TEST(Hdf5Contents, LinksToOtherPlacesAndCirclesAreNotFollowed) {
  Contents const all = contents_of(image([](H5::H5File& file) {
    file.createGroup("/a").createGroup("b");
    file.link(H5L_TYPE_HARD, "/a", "/a/b/again");
    file.link(H5L_TYPE_SOFT, "/a/b", "/soft");
    H5Lcreate_external("/etc/passwd", "/", file.getId(), "elsewhere", H5P_DEFAULT, H5P_DEFAULT);
  }));
  EXPECT_THAT(all, ElementsAre(Key("/"), Key("/a"), Key("/a/b"), Key("/a/b/again")));
  EXPECT_EQ(all.at("/a/b").values.state, State::whole);
  EXPECT_EQ(all.at("/a/b/again").values.state, State::unreadable);
}

TEST(Hdf5Contents, ImpossibleSizesAreReportedAndNotRead) {
  std::string const claims = image([](H5::H5File& file) {
    H5::DSetCreatPropList chunks;
    hsize_t const chunk = 1024, count = 1000000000000;
    chunks.setChunk(1, &chunk);
    file.createDataSet("claim", H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &count), chunks);
  });
  Reader const in(claims);
  EXPECT_EQ(in.object("/claim").values.state, State::impossible_size);
  EXPECT_EQ(in.object("/claim").values.count(), 1000000000000u);
  EXPECT_THAT(message_of([&] { (void)in.array<double>("/claim"); }), HasSubstr("'/claim' has an impossible size"));
}

TEST(Hdf5Contents, OnlyRequestedObjectsAreRead) {
  std::string const both = image([](H5::H5File& file) {
    write<double>(file, "few", H5::PredType::NATIVE_DOUBLE, {1, 2});
    write<double>(file, "many", H5::PredType::NATIVE_DOUBLE, std::vector<double>(100, 3));
  });
  Reader const in(both, {.largest = 16});
  EXPECT_THAT(in.array<double>("/few"), ElementsAre(1, 2));
  EXPECT_EQ(in.shape("/many"), Sizes{100});
  EXPECT_THAT(message_of([&] { (void)in.array<double>("/many"); }), HasSubstr("'/many' was not read"));
  EXPECT_EQ(slab(both, "/many", 98, 2), (std::vector<double>{3, 3}));
  EXPECT_THAT(message_of([&] { (void)slab(both, "/many", 99, 2); }), HasSubstr("'/many' cannot be read"));
}

// The library frees what it never had, or sees the damage, as its memory happens to be: an input on which a fuzzer
// ended.
TEST(Hdf5Contents, AFileThatBreaksTheLibraryIsAnError) {
  std::ifstream file(STRAY_SOURCE_DIR "/fuzz/corpus/motion/bad_free.hdf5", std::ios::binary);
  std::string const bytes(std::istreambuf_iterator<char>(file), {});
  ASSERT_EQ(bytes.size(), 6888u);
  EXPECT_THAT(message_of([&] { (void)contents_of(bytes); }), HasSubstr("HDF5"));
}

TEST(Hdf5Contents, AsBytesAndBack) {
  Writer out;
  out.group("/g", "of numbers");
  out.array("/g/x", std::vector<double>{1, 2, 3}, "m");
  out.strings("/names", {"a", "bc"});
  Contents const contents = own_contents(out.bytes());
  std::string const bytes = packed(contents);
  EXPECT_EQ(packed(unpacked(bytes)), bytes);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW((void)unpacked(std::string_view(bytes).substr(0, length)), InputError) << length;
}

// Numbers of full precision would lose a seventh of their size for most of the time of writing.
TEST(Hdf5Contents, OnlyWhatShrinksIsCompressed) {
  constexpr std::size_t count = 20000;
  std::vector<double> noise, steps;
  Rng rng(1, 0, 0, Stream::motion);
  for (std::size_t i = 0; i < count; ++i) {
    noise.push_back(rng.uniform());
    steps.push_back(double(i / 100));
  }
  for (auto const& [values, least, most] :
       {std::tuple(noise, 8 * count, 9 * count), std::tuple(steps, 0 * count, count)}) {
    Writer out;
    out.array("/values", values, "1");
    std::string const bytes = out.bytes();
    EXPECT_GE(bytes.size(), least);
    EXPECT_LE(bytes.size(), most);
    EXPECT_EQ(Reader(bytes).array<double>("/values"), values);
  }
}

// An empty data set that claims to hold more texts than any memory.
TEST(Hdf5Contents, TextsOfNoLengthAreErrors) {
  Contents contents;
  Values& names = contents["/names"].values;
  names.kind = Kind::text, names.state = State::whole, names.shape = {std::uint64_t{1} << 60};
  EXPECT_THROW((void)unpacked(packed(contents)), InputError);
  names.size = 1, names.shape = {0};
  EXPECT_EQ(unpacked(packed(contents)).size(), 1u);
}

}  // namespace
}  // namespace straytrace::io::hdf5
