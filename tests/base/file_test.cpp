/// A file is written whole or not at all.

#include "hydrapod/base/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "support/run_program.hpp"

namespace hydrapod::base {
namespace {
namespace fs = std::filesystem;
using test::TemporaryFolder;

std::ptrdiff_t files_in(const TemporaryFolder& folder) {
  return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator());
}

std::string message_of(const std::string& path) {
  try {
    write_file_whole(path, "text");
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(WriteFileWhole, ReplacesTheFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.txt").string();
  write_file_whole(path, "first");
  write_file_whole(path, "second");
  EXPECT_EQ(test::read_text(path), "second");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(WriteFileWhole, KeepsThePermissionsOfTheFileItReplaces) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.txt";
  test::write_text(path, "first");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  write_file_whole(path.string(), "second");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(WriteFileWhole, FollowsASymbolicLink) {
  const TemporaryFolder folder;
  test::write_text(folder / "target", "first");
  fs::create_symlink("target", folder / "link");
  write_file_whole((folder / "link").string(), "second");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(test::read_text(folder / "target"), "second");
}

TEST(WriteFileWhole, FollowsASymbolicLinkToWhatIsNotThereYet) {
  const TemporaryFolder folder;
  fs::create_symlink("target", folder / "middle");
  fs::create_symlink(folder / "middle", folder / "link");
  write_file_whole((folder / "link").string(), "first");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_TRUE(fs::is_symlink(folder / "middle"));
  EXPECT_EQ(test::read_text(folder / "target"), "first");
}

TEST(WriteFileWhole, NamesTheFolderThatIsMissing) {
  const TemporaryFolder folder;
  const std::string missing = (folder / "no").string();
  EXPECT_EQ(message_of(missing + "/a.txt"), missing + "/a.txt: error: cannot write the file: " +
                                                "there is no folder '" + missing + "'");
}

TEST(WriteFileWhole, RefusesAFolderAndAnEmptyName) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of(folder.path().string()), testing::HasSubstr("Is a directory"));
  EXPECT_THAT(message_of(""), testing::HasSubstr("cannot write the file"));
}

TEST(WriteFileWhole, ReportsAFullDisk) {
  try {
    write_file_whole("/dev/full", "text");
    FAIL() << "nothing thrown";
  } catch (const ComputationError& error) {
    EXPECT_STREQ(error.what(), "writing '/dev/full' failed: No space left on device");
  }
}

TEST(PartFile, TwoWritersOfOneNameHaveTwoPartsAndOneGetsIt) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.dat").string();
  PartFile first(path), second(path);
  EXPECT_NE(first.part(), second.part());
  test::write_text(first.part(), "first");
  test::write_text(second.part(), "second");
  EXPECT_EQ(second.commit(), path);
  EXPECT_THROW(first.commit(), ComputationError);
  EXPECT_EQ(test::read_text(path), "second");
  EXPECT_EQ(test::read_text(path + ".part"), "first");
}

TEST(PartFile, LeavesThePartOfAKilledRun) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.dat").string();
  test::write_text(path + ".part", "what was measured");
  {
    PartFile file(path);
    test::write_text(file.part(), "new");
    file.commit();
  }
  EXPECT_EQ(test::read_text(path), "new");
  EXPECT_EQ(test::read_text(path + ".part"), "what was measured");
  EXPECT_EQ(files_in(folder), 2);
}

TEST(PartFile, LeavesAFileThatCameToBeThereBetweenTheCheckAndThePart) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.dat").string(), own = (folder / "b.dat").string();
  const auto must_stay = [](const std::string& at) { return test::read_text(at) != "a table"; };
  expect_no_file(path, must_stay);
  test::write_text(path, "of another program");
  EXPECT_THROW(PartFile{path}, InputError);
  EXPECT_THROW(write_file_whole(path, "own"), InputError);
  EXPECT_EQ(test::read_text(path), "of another program");
  test::write_text(path, "a table");
  EXPECT_NO_THROW(PartFile{path});
  test::write_text(path, "of another program");
  expect_no_file(own, must_stay);
  for (const std::string text : {"first", "second"}) {  // its own it may replace
    PartFile file(own);
    test::write_text(file.part(), text);
    EXPECT_EQ(file.commit(), own);
    EXPECT_EQ(test::read_text(own), text);
  }
  fs::remove(path);
  EXPECT_NO_THROW(PartFile{path});
  write_file_whole(path, "first");
  write_file_whole(path, "second");
  EXPECT_EQ(test::read_text(path), "second");
}

TEST(PartFile, AnIncompleteOneReplacesNoFile) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.dat").string();
  test::write_text(path, "complete");
  {
    PartFile file(path);
    test::write_text(file.part(), "half");
    EXPECT_EQ(file.commit(false), path + ".part");
  }
  EXPECT_EQ(test::read_text(path), "complete");
  EXPECT_EQ(test::read_text(path + ".part"), "half");
  PartFile alone((folder / "b.dat").string());  // where there is none, it is better than nothing
  test::write_text(alone.part(), "half");
  EXPECT_EQ(alone.commit(false), alone.path());
}

TEST(PartFile, FollowsNoLinkThatStandsWhereItsPartWouldBe) {
  const TemporaryFolder folder;
  test::write_text(folder / "precious", "mine");
  fs::create_symlink(folder / "precious", folder / "a.dat.part");
  PartFile file((folder / "a.dat").string());
  test::write_text(file.part(), "new");
  file.commit();
  EXPECT_EQ(test::read_text(folder / "precious"), "mine");
}

TEST(File, ThatIsTooLargeIsRefusedAndNotCutOff) {
  const TemporaryFolder folder;
  const std::string path = folder / "large.txt";
  constexpr std::size_t largest = std::size_t{3} << 20U;
  test::write_text(path, std::string(largest, 'a'));
  EXPECT_EQ(read_file(path, largest, "a list").size(), largest);
  test::write_text(path, std::string(largest + 1, 'a'));
  try {
    read_file(path, largest, "a list");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              path + ": error: is larger than 3 MiB, expected a list of some kilobytes");
  }
}

}  // namespace
}  // namespace hydrapod::base
