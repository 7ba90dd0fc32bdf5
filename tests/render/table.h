#pragma once
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace pbrt::test {

/// Lines on standard output at once, and in <build>/tables/NAME.txt at the end of the program.
class Table : public testing::Environment {
  public:
    Table(const std::string &name, const std::string &head) : name_(name), head_(head) {}
    void Line(const std::string &line) {
        fmt::print("{}\n", line);
        std::fflush(stdout);
        lines_.push_back(line);
    }
    void SetUp() override {
        if (!head_.empty()) Line(head_);
    }
    void TearDown() override {
        if (lines_.empty()) return;
        const auto folder = std::filesystem::path(PBRT_BINARY_DIR) / "tables";
        std::filesystem::create_directories(folder);
        std::ofstream(folder / (name_ + ".txt")) << fmt::format("{}\n", fmt::join(lines_, "\n"));
    }

  private:
    std::string name_, head_;
    std::vector<std::string> lines_;
};

/// To be called before main; `head` is the first line if not empty. GoogleTest owns the table.
inline Table &AddTable(const std::string &name, const std::string &head = "") {
    auto *table = new Table(name, head);
    testing::AddGlobalTestEnvironment(table);
    return *table;
}

}  // namespace pbrt::test
