#pragma once
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"

namespace pbrt::test {

/// Gives every test its own temporary folder, which is removed at the end.
class FolderTest : public ::testing::Test {
  protected:
    FolderTest() {
        std::string name = (std::filesystem::temp_directory_path() / "pbrt_test_XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~FolderTest() override {
        std::error_code ignored;
        std::filesystem::permissions(folder_, std::filesystem::perms::owner_all, ignored);
        std::filesystem::remove_all(folder_, ignored);
    }
    std::string Path(const std::string &name) const { return (folder_ / name).string(); }
    /// Writes a file, in a folder that need not exist. Returns its path.
    std::string Write(const std::string &name, const std::string &text) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return Path(name);
    }
    std::ptrdiff_t FileCount() const {
        return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
    }
    std::filesystem::path folder_;
};

}  // namespace pbrt::test
