#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>

#include "pbrt/images/image.h"

namespace pbrt {

struct Outcome {
    int status = -1;
    std::string out, err;
};

inline std::string FileText(const std::string &path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
}

class Imgtool : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto *info = ::testing::UnitTest::GetInstance()->current_test_info();
        directory_ = std::filesystem::temp_directory_path() /
                     (std::string("pbrt_imgtool_") + info->name() + "_" + std::to_string(getpid()));
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

    std::string Path(const std::string &name) const { return (directory_ / name).string(); }

    // Runs imgtool in the folder of the test. The program must exit by itself.
    Outcome Run(const std::string &arguments) const {
        static std::atomic<int> runs{0};
        const std::string log = Path(".log" + std::to_string(runs++));
        const std::string command = "cd '" + directory_.string() + "' && '" + PBRT_IMGTOOL + "' " + arguments + " > " +
                                    log + ".out 2> " + log + ".err";
        const int raw = std::system(command.c_str());
        EXPECT_TRUE(WIFEXITED(raw)) << arguments;
        return {WEXITSTATUS(raw), FileText(log + ".out"), FileText(log + ".err")};
    }
    // Runs independent commands, several at a time, because loading the libraries takes longest.
    std::vector<Outcome> RunAll(const std::vector<std::string> &commands) const {
        std::vector<std::future<Outcome>> running;
        for (const std::string &c : commands)
            running.push_back(std::async(std::launch::async, [this, c] { return Run(c); }));
        std::vector<Outcome> outcomes;
        for (auto &r : running) outcomes.push_back(r.get());
        return outcomes;
    }
    // The cases are pairs of arguments and a part of the message. Expects status 1 and nothing on standard output.
    void ExpectErrors(const std::vector<std::pair<std::string, std::string>> &cases) const {
        std::vector<std::string> commands;
        for (const auto &c : cases) commands.push_back(c.first);
        const std::vector<Outcome> outcomes = RunAll(commands);
        for (size_t i = 0; i < cases.size(); ++i) {
            const Outcome &o = outcomes[i];
            EXPECT_EQ(o.status, 1) << commands[i];
            EXPECT_EQ(o.out, "") << commands[i];
            EXPECT_NE(o.err.find("Error"), std::string::npos) << commands[i] << "\n" << o.err;
            EXPECT_NE(o.err.find(cases[i].second), std::string::npos) << commands[i] << "\n" << o.err;
        }
    }

    // Values 0.1, 0.2, ... in every channel.
    Image Write(const std::string &name, int width, int height, const std::vector<std::string> &channels,
                Float offset = 0) const {
        Image image(PixelFormat::Float, {width, height}, channels);
        Float value = offset;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < image.ChannelCount(); ++c) image.Set({x, y}, c, value += 0.1f);
        WriteImage(Path(name), image);
        return image;
    }
    std::filesystem::path directory_;
};

inline const std::vector<std::string> kRgb = {"R", "G", "B"};
inline bool Has(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

}  // namespace pbrt
