// SPDX-License-Identifier: BSD-3-Clause
// A full disk, missing rights, a kill at any moment: what was there stays, what is there is whole, nothing else is
// left.
#include <chrono>
#include <fcntl.h>
#include <random>
#include <thread>

#include "base/every_module.hpp"
#include "results/results.hpp"
#include "scenes/limits.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

Words traced_into(std::string const& run_file, int histories) {
  return {"trace", et_hf, "-p", "rings=40", "-o", run_file, "--quiet", "--histories", std::to_string(histories)};
}
Words run_into(std::string const& folder, int histories) {
  return {"run", et_hf, "-p", "rings=40", "-o", folder, "--quiet", "--histories", std::to_string(histories)};
}
Words names_in(std::string const& folder) {
  Words names;
  for (auto const& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(entry.path().filename());
  return names;
}

// Only the process itself is killed: those it started must see to their end.
void run_and_kill(Words words, std::chrono::milliseconds after) {
  pid_t const child = ::fork();
  if (child == 0) {
    std::vector<char*> arguments{const_cast<char*>(STRAY_PROGRAM)};
    for (std::string& w : words) arguments.push_back(w.data());
    arguments.push_back(nullptr);
    int const nothing = ::open("/dev/null", O_RDWR);
    for (int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
    ::setenv("STRAYTRACE_PYTHON", "/bin/false", 1);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  std::this_thread::sleep_for(after);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

// A limit on the size of files emulates a full disk.
TEST(Losses, AFullDiskLosesNothing) {
  Folder const folder;
  ASSERT_EQ(straytrace(run_into(folder / "a", 4096)).code, 0);
  std::string const before = text_of(folder / "a/run.h5");
  Words const names = names_in(folder / "a");
  Limit const disk(RLIMIT_FSIZE, 20000);
  for (Words const& words :
       {run_into(folder / "a", 8192), traced_into(folder / "a/run.h5", 8192), traced_into(folder / "b.h5", 4096),
        Words{"noise", folder / "a/run.h5", "-o", folder / "a", "--force"},
        Words{"report", folder / "a/run.h5", "-o", folder / "c.html"},
        Words{"scan", et_hf, "rings=40", "--histories", "4096", "-o", folder / "scan"}}) {
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2) << words.front();
    EXPECT_THAT(r.err, HasSubstr("File too large\n  choose another place, free disk space")) << words.front();
  }
  EXPECT_EQ(text_of(folder / "a/run.h5"), before);
  EXPECT_EQ(names_in(folder.path()), names);
}

TEST(Losses, StandardOutputThatIsFull) {
  for (std::string const words : {"schema", "library", "explain half_angle"})
    EXPECT_EQ(WEXITSTATUS(std::system((std::string(STRAY_PROGRAM) + " " + words + " >/dev/full 2>/dev/null").c_str())),
              2);
}

// Results never replace devices, which root could do.
TEST(Losses, DevicesAreNotReplaced) {
  Folder const folder;
  ASSERT_EQ(straytrace(traced_into(folder / "a.h5", 4096)).code, 0);
  for (Words const& words : {Words{"report", folder / "a.h5", "-o", "/dev/full"},
                             Words{"view", folder / "a.h5", "-o", "/dev/full"}, traced_into("/dev/full", 4096)}) {
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2) << words.front();
    EXPECT_THAT(r.err, HasSubstr("'/dev/full': it is not a regular file")) << words.front();
  }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

// Reported before anything is traced, and without leftovers of the attempt.
TEST(Losses, MissingRights) {
  Folder const folder;
  fs::copy_file(et_hf, folder / "secret.yaml");
  ASSERT_EQ(straytrace(traced_into(folder / "run.h5", 4096)).code, 0);
  fs::create_directory(folder / "closed");
  fs::permissions(folder / "secret.yaml", fs::perms::none);
  fs::permissions(folder / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  fs::permissions(folder / "run.h5", fs::perms::owner_read);
  EXPECT_TRUE(without_rights([&] {
    for (Words const& words : {run_into(folder / "closed", 1 << 30), traced_into(folder / "closed/a.h5", 1 << 30),
                               Words{"check", folder / "secret.yaml"}}) {
      Finished const r = straytrace(words, {".", false, 10});
      EXPECT_EQ(r.code, 2) << words.front() << r.err;
      EXPECT_THAT(r.err, HasSubstr("Permission denied")) << words.front();
    }
    EXPECT_EQ(straytrace({"paths", folder / "run.h5"}).code, 0) << "a run that cannot be written can be read";
  }));
  fs::permissions(folder / "closed", fs::perms::owner_all);
  EXPECT_TRUE(fs::is_empty(folder / "closed"));
}

TEST(Losses, AFailedCommandLeavesNoFolder) {
  Folder const folder;
  for (Words const& words :
       {Words{"scan", et_hf, "nothing=1,2", "-o", folder / "new/scan"},
        Words{"scan", et_hf, "--invert", "param(nothing)", "nothing=1..2", "-o", folder / "new"},
        Words{"scan", et_hf, "--invert", "brdf(wall)", "--against", "nothing", "-o", folder / "new"},
        Words{"budget", "nothing", "-o", folder / "new/../other"}}) {
    EXPECT_EQ(straytrace(words).code, 2) << words[2];
    EXPECT_TRUE(names_in(folder.path()).empty()) << words[2];
  }
}

// A link is not a folder of ours, wherever it leads.
TEST(Losses, LinksThatLeadNowhereStay) {
  Folder const folder;
  fs::create_symlink("nowhere", folder / "link");
  for (std::string const& out : {folder / "link", folder / "link/x", (folder / "link") + "/"}) {
    EXPECT_EQ(straytrace({"budget", "aligo", "-o", out}).code, 2) << out;
    EXPECT_TRUE(fs::is_symlink(folder / "link")) << out;
  }
}

// The name while it is written is longer than its own: that must not come up when all is traced.
TEST(Losses, LongNames) {
  Folder const folder;
  EXPECT_EQ(straytrace(traced_into(folder / (std::string(253, 'a') + ".h5"), 4096)).code, 2);
  EXPECT_EQ(straytrace(traced_into(folder / (std::string(253, 'a') + ".h5"), 1 << 30), {".", false, 10}).code, 2);
  Finished const r = straytrace(traced_into(folder / (std::string(252, 'a') + ".h5"), 4096));
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(names_in(folder.path()).size(), 1u);
}

TEST(Losses, NoPlaceForPictures) {
  Folder const folder;
  ASSERT_EQ(straytrace(traced_into(folder / "a.h5", 4096)).code, 0);
  std::string const command = std::string("TMPDIR=/nowhere ") + STRAY_PROGRAM + " report " + (folder / "a.h5");
  EXPECT_EQ(WEXITSTATUS(std::system((command + " 2>&1 | grep -q \"folder in '/nowhere' for the picture\"").c_str())),
            0);
  EXPECT_EQ(WEXITSTATUS(std::system((command + " >/dev/null 2>&1").c_str())), 2);
  EXPECT_EQ(names_in(folder.path()), Words{"a.h5"});
}

// Results on another disk: the link stays, and what it leads to is the result.
TEST(Losses, LinksAreFollowed) {
  Folder const folder;
  fs::create_directory(folder / "disk");
  fs::create_symlink("disk/a.h5", folder / "link.h5");
  EXPECT_EQ(straytrace(traced_into(folder / "link.h5", 4096)).code, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "link.h5"));
  EXPECT_NO_THROW(read_run(folder / "disk/a.h5"));
  fs::create_symlink("nowhere/a.h5", folder / "dangling.h5");
  EXPECT_EQ(straytrace(traced_into(folder / "dangling.h5", 1 << 30), {".", false, 10}).code, 2);
}

// Whenever it is killed, run files are whole and nothing half-written lies about; then the same command succeeds.
TEST(Losses, KilledAtAnyMoment) {
  Folder const folder;
  ASSERT_EQ(straytrace(traced_into(folder / "source.h5", 4096)).code, 0);
  std::mt19937 random(7);
  std::string const place = folder / "place";
  for (Words const& words :
       {run_into(place, 8192), Words{"noise", folder / "source.h5", "-o", place, "--force"},
        Words{"report", folder / "source.h5", "-o", place + "/page.html"},
        Words{"scan", et_hf, "rings=40,41", "--histories", "4096", "-o", place, "--quiet", "--jobs", "2"}}) {
    for (int i = 0; i < 4; ++i) {
      run_and_kill(words, std::chrono::milliseconds(random() % 300));
      if (!fs::exists(place)) continue;
      for (auto const& entry : fs::recursive_directory_iterator(place)) {
        EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
        if (entry.path().extension() == ".h5") {
          EXPECT_NO_THROW(read_run(entry.path())) << words.front();
        }
      }
    }
    Finished const again = straytrace(words);
    EXPECT_EQ(again.code, 0) << words.front() << again.err;
  }
}

// A clock that was set back or forth decides nothing: what is finished stays finished.
TEST(Losses, FilesFromTheFuture) {
  Folder const folder;
  Words const words{"scan", et_hf,           "rings=40,41", "--histories", "4096",
                    "-o",   folder / "scan", "--quiet",     "--jobs",      "2"};
  ASSERT_EQ(straytrace(words).code, 0);
  std::string table = text_of(folder / "scan/scan.csv");
  for (std::size_t at; (at = table.find(",traced,")) != table.npos;) table.replace(at, 8, ",stored,");
  for (auto const& entry : fs::recursive_directory_iterator(folder / "scan"))
    fs::last_write_time(entry.path(), fs::file_time_type::clock::now() + std::chrono::hours(24 * 3650));
  Finished const again = straytrace(words);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(text_of(folder / "scan/scan.csv"), table);
}

}  // namespace
}  // namespace straytrace::testing
