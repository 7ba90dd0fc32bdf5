#include "pbrt/core/files.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
  protected:
    Files() {
        std::string name = (fs::temp_directory_path() / "pbrt_core_XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~Files() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    std::string Write(const std::string &name, const std::string &text) {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return (folder_ / name).string();
    }
    std::string Gzip(const std::string &name, const std::string &text) {
        std::string path = (folder_ / name).string();
        gzFile f = gzopen(path.c_str(), "wb");
        gzwrite(f, text.data(), static_cast<unsigned>(text.size()));
        gzclose(f);
        return path;
    }
    fs::path folder_;
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

TEST_F(Files, UnreadableFilesSayWhy) {
    auto reason = [](const std::string &path) -> std::string {
        try {
            ReadFileContents(path);
            return "";
        } catch (const UserError &e) {
            return e.what();
        }
    };
    EXPECT_NE(reason((folder_ / "none").string()).find("No such file"), std::string::npos);
    EXPECT_NE(reason(folder_.string()).find("is a directory"), std::string::npos);
    std::string path = Gzip("cut.gz", LongText());
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_NE(reason(path), "");
}

TEST_F(Files, NamesAreLookedForBesideTheSceneFirst) {
    std::string here = Write("x.png", "");
    FileResolver resolver(folder_);
    EXPECT_EQ(resolver.Resolve("x.png"), here);
    EXPECT_EQ(resolver.Resolve("y.png"), "y.png");
    EXPECT_EQ(resolver.Resolve("/abs/z.png"), "/abs/z.png");
    EXPECT_EQ(FileResolver().Resolve("x.png"), "x.png");
}

TEST_F(Files, WriteThenRenameReplacesOrLeavesAlone) {
    std::string path = Write("out.exr", "old");
    WriteThenRename(path, [&](const std::string &name) {
        EXPECT_EQ(fs::path(name).extension(), ".exr");
        std::ofstream(name) << "new";
        EXPECT_EQ(ReadFileContents(path), "old");
    });
    EXPECT_EQ(ReadFileContents(path), "new");
    EXPECT_THROW(WriteThenRename(path,
                                 [&](const std::string &name) {
                                     std::ofstream(name) << "half";
                                     throw UserError("disk full");
                                 }),
                 UserError);
    EXPECT_EQ(ReadFileContents(path), "new");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "nothing left behind";
}

}  // namespace
}  // namespace pbrt
