#include <fcntl.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include "support/errors.h"
#include "support/folder_test.h"
#include "support/small_files.h"

namespace pbrt {
namespace {

namespace fs = std::filesystem;
using test::MessageOf, test::SmallFilesOnly;

class WriteFileTest : public test::FolderTest {};

mode_t ModeOf(const std::string &path) {
    struct stat status {};
    EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
    return status.st_mode & 0777;
}

TEST_F(WriteFileTest, ReplacesTheContentAndLeavesNothingElse) {
    const std::string path = Write("out.exr", "an old and longer content"), content("new\0\n", 5);
    WriteFile(path, content);
    EXPECT_EQ(ReadFileContents(path), content);
    WriteFile(path, "");
    EXPECT_EQ(ReadFileContents(path), "");
    WriteFile(Path("fresh"), "x");
    EXPECT_EQ(ReadFileContents(Path("fresh")), "x");
    EXPECT_EQ(FileCount(), 2);
}

TEST_F(WriteFileTest, AFullDiskIsAnErrorAndKeepsTheOldFile) {
    const std::string path = Write("out", "old"), big(100000, 'x');
    {
        const SmallFilesOnly limit(50000);
        test::ExpectError([&] { WriteFile(path, big); }, {path + ": ", "File too large"});
    }
    EXPECT_EQ(ReadFileContents(path), "old");
    EXPECT_EQ(FileCount(), 1);
    WriteFile(path, big);
    EXPECT_EQ(ReadFileContents(path), big);
    fs::create_symlink("/dev/full", Path("full"));
    test::ExpectError([&] { WriteFile(Path("full"), "x"); }, {"No space left"});
}

TEST_F(WriteFileTest, LinksStayAndLeadToTheNewContent) {
    fs::create_directory(Path("deep"));
    Write("deep/real", "old");
    fs::create_symlink("deep/real", Path("near"));
    fs::create_symlink(Path("near"), Path("far"));
    WriteFile(Path("far"), "new");
    EXPECT_EQ(fs::read_symlink(Path("near")), "deep/real");
    EXPECT_TRUE(fs::is_symlink(Path("far")));
    EXPECT_EQ(ReadFileContents(Path("deep/real")), "new");
    // Writing to a link whose target does not exist creates the target.
    fs::create_symlink("deep/fresh", Path("dangling"));
    WriteFile(Path("dangling"), "made");
    EXPECT_EQ(ReadFileContents(Path("deep/fresh")), "made");
    EXPECT_TRUE(fs::is_symlink(Path("dangling")));
    fs::create_symlink("loop", Path("loop"));
    test::ExpectError([&] { WriteFile(Path("loop"), "x"); }, {"loop: cannot be written"});
}

TEST_F(WriteFileTest, PipesAndDevicesAreWrittenTo) {
    const std::string pipe = Path("pipe"), text(200000, 'p');
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::thread writer([&] { WriteFile(pipe, text); });
    EXPECT_EQ(ReadFileContents(pipe, ReadFrom::FilesAndPipes), text);
    writer.join();
    EXPECT_TRUE(fs::is_fifo(pipe));
    WriteFile("/dev/null", text);
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    EXPECT_EQ(FileCount(), 1);
}

// If standard output is redirected to a file, the bytes go into that file, which must not be replaced by another one of
// the same name.
TEST_F(WriteFileTest, StandardOutputIsNotReplaced) {
    const int file = open(Path("log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ASSERT_GE(file, 0);
    const std::string name = "/proc/self/fd/" + std::to_string(file);
    EXPECT_EQ(write(file, "a", 1), 1);
    WriteFile(name, "b");
    EXPECT_EQ(write(file, "c", 1), 1);
    close(file);
    EXPECT_EQ(ReadFileContents(Path("log")), "abc");
}

// A pipe whose reader has gone away must give an error, not end the process.
TEST_F(WriteFileTest, APipeWithoutReaderIsAnError) {
    const std::string pipe = Path("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::thread reader([&] {
        const int file = open(pipe.c_str(), O_RDONLY);
        char byte = 0;
        EXPECT_EQ(read(file, &byte, 1), 1);
        close(file);
    });
    test::ExpectError([&] { WriteFile(pipe, std::string(1 << 20, 'x')); }, {"Broken pipe"});
    reader.join();
}

TEST_F(WriteFileTest, PermissionsStayAndNewFilesHaveTheUsualOnes) {
    const std::string old = Write("old", "x");
    ASSERT_EQ(chmod(old.c_str(), 0640), 0);
    WriteFile(old, "y");
    EXPECT_EQ(ModeOf(old), 0640u);
    const mode_t mask = umask(0027);
    WriteFile(Path("new"), "y");
    umask(mask);
    EXPECT_EQ(ModeOf(Path("new")), 0640u);
}

TEST_F(WriteFileTest, NamesMayBeAsLongAsTheDiskAllows) {
    for (size_t length : {200u, 252u, 255u}) {
        const std::string path = Path(std::string(length - 4, 'n') + ".exr");
        CheckWritable(path);
        WriteFile(path, "long");
        EXPECT_EQ(ReadFileContents(path), "long");
    }
    EXPECT_EQ(FileCount(), 3);
    const std::string path = Path(std::string(256, 'n'));
    test::ExpectError([&] { CheckWritable(path); }, {"File name too long"});
    test::ExpectError([&] { WriteFile(path, "x"); }, {"File name too long"});
}

TEST_F(WriteFileTest, UnwritableFilesAreReportedInAdvance) {
    Write("file", "x");
    const std::string guarded = Write("guarded", "keep");
    ASSERT_EQ(chmod(guarded.c_str(), 0444), 0);
    fs::create_directory(Path("folder"));
    const auto expect = [](const std::string &path, const std::string &part) {
        const std::string early = MessageOf([&] { CheckWritable(path); });
        test::ExpectWords(early, {part});
        EXPECT_EQ(MessageOf([&] { WriteFile(path, "x"); }), early);
    };
    expect("", "is not the name");
    expect(Path("folder"), "is a folder");
    expect(Path("folder") + "/", "is not the name");
    expect(Path("none/a.exr"), "none does not exist");
    expect(Path("file/a.exr"), "cannot be written");
    expect(guarded, "write-protected");
    expect("/proc/a.exr", "/proc");
    EXPECT_EQ(ReadFileContents(guarded), "keep");
    if (geteuid() != 0) {  // root may write everywhere
        fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
        test::ExpectError([&] { CheckWritable(Path("b")); }, {"is not writable"});
        fs::permissions(folder_, fs::perms::owner_all);
    }
    CheckWritable(Path("b"));
    CheckWritable(Path("file"));
    EXPECT_EQ(ReadFileContents(Path("file")), "x");
    EXPECT_EQ(FileCount(), 3);
}

TEST_F(WriteFileTest, ThreadsMayWriteAtOnce) {
    const std::string a(50000, 'a'), b(70000, 'b');
    {
        std::jthread one([&] {
            for (int i = 0; i < 20; ++i) WriteFile(Path("same"), a);
        });
        for (int i = 0; i < 20; ++i) WriteFile(Path("same"), b);
    }
    const std::string content = ReadFileContents(Path("same"));
    EXPECT_TRUE(content == a || content == b);
    EXPECT_EQ(FileCount(), 1);
}

}  // namespace
}  // namespace pbrt
