#include "pbrt/core/files.h"

#include <zlib.h>

#include <thread>

#include "support/errors.h"
#include "support/folder_test.h"

namespace pbrt {
namespace {

namespace fs = std::filesystem;
using test::MessageOf;

class Files : public test::FolderTest {
  protected:
    std::string Gzip(const std::string &name, const std::string &text) {
        gzFile f = gzopen(Path(name).c_str(), "wb");
        gzwrite(f, text.data(), unsigned(text.size()));
        gzclose(f);
        return Path(name);
    }
};

std::string LongText() {
    std::string text;
    for (int i = 0; i < 200000; ++i) text += std::to_string(i * 7919);
    return text;
}

TEST_F(Files, PlainAndCompressedContentsAreTheSame) {
    std::string text = LongText() + std::string("\0\xff\n", 3);
    EXPECT_EQ(ReadFileContents(Write("a", text)), text);
    EXPECT_EQ(ReadFileContents(Gzip("a.gz", text)), text);
    EXPECT_EQ(ReadFileContents(Gzip("not_called_gz", text)), text);
    EXPECT_EQ(ReadFileContents(Write("empty", "")), "");
}

TEST_F(Files, ErrorsOfUnreadableFilesHaveTheReason) {
    auto reason = [](const std::string &path) { return MessageOf([&] { ReadFileContents(path); }); };
    test::ExpectWords(reason(Path("none")), {"No such file"});
    test::ExpectWords(reason(folder_.string()), {"is a directory"});
    std::string path = Gzip("cut.gz", LongText());
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_NE(reason(path), "");
}

TEST_F(Files, NamesAreResolvedBesideTheSceneFirst) {
    std::string here = Write("x.png", "");
    FileResolver resolver(folder_);
    EXPECT_EQ(resolver.Resolve("x.png"), here);
    EXPECT_EQ(resolver.Resolve("y.png"), "y.png");
    EXPECT_EQ(resolver.Resolve("/abs/z.png"), "/abs/z.png");
    EXPECT_EQ(FileResolver().Resolve("x.png"), "x.png");
}

TEST_F(Files, TwoNamesMayLeadToOneFile) {
    Write("a", "");
    Write("b", "");
    fs::create_directory(Path("deep"));
    fs::create_symlink(Path("a"), Path("link"));
    for (const auto &[one, other] : {std::pair("a", "a"), {"a", "deep/../a"}, {"link", "./a"}, {"new", "deep/../new"}})
        EXPECT_TRUE(IsSameFile(Path(one), Path(other))) << one << " " << other;
    for (const auto &[one, other] : {std::pair("a", "b"), {"a", "new"}, {"new", "a"}, {"new", "deep/new"}})
        EXPECT_FALSE(IsSameFile(Path(one), Path(other))) << one << " " << other;
    EXPECT_TRUE(IsSameFile("no_such_file", "./no_such_file"));
    EXPECT_TRUE(IsSameFile("no_such_file", fs::absolute("no_such_file").string()));
    EXPECT_FALSE(IsSameFile("/dev/null", "/dev/null")) << "a device keeps nothing that could be overwritten";
}

// A gzip bomb: some kilobytes that unpack to any number of bytes.
TEST_F(Files, WhatDoesNotFitIntoMemoryThrowsBeforeItIsRead) {
    const std::string large(100 << 20, 'x');
    auto little = [] { return 50e6; };
    for (const std::string &path : {Gzip("bomb.gz", large), Write("plain", large)}) {
        test::ExpectError([&] { ReadFileContents(path, ReadFrom::Files, little); },
                          {path + ": ", "too large", "50 MB"});
        EXPECT_TRUE(ReadFileContents(path, ReadFrom::Files, [] { return 500e6; }) == large);
    }
    EXPECT_LT(fs::file_size(Path("bomb.gz")), 1u << 18);
    EXPECT_EQ(ReadFileContents(Gzip("small.gz", LongText()), ReadFrom::Files, little), LongText());
    EXPECT_EQ(ReadFileContents(Gzip("small.gz", LongText()), ReadFrom::Files, [] { return 0.0; }), LongText());
}

// The program must neither wait for a pipe nor read a device without an end.
TEST_F(Files, PipesAndDevicesAreNoFiles) {
    const std::string pipe = Path("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    test::ExpectError([&] { ReadFileContents(pipe); }, {"is a pipe"});
    for (ReadFrom from : {ReadFrom::Files, ReadFrom::FilesAndPipes})
        test::ExpectError([&] { ReadFileContents("/dev/zero", from); }, {"is a device"});
    std::thread writer([&] { std::ofstream(pipe) << LongText(); });
    EXPECT_EQ(ReadFileContents(pipe, ReadFrom::FilesAndPipes), LongText());
    writer.join();
}

TEST_F(Files, ExtensionsAreComparedInSmallLetters) {
    EXPECT_EQ(LowerExtension("A/B.C/D.EXR"), ".exr");
    EXPECT_EQ(LowerExtension("x.y/z"), "");
}

}  // namespace
}  // namespace pbrt
