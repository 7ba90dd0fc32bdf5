#include <OpenImageIO/imageio.h>

#include <barrier>
#include <cstring>
#include <thread>

#include "image_fixtures.h"

namespace pbrt::test {

namespace {

/// An ICC profile of a monitor by "IEC ", model "sRGB", with `tags` text tags with private names.
std::vector<uint8_t> Profile(int number, int tags) {
    std::vector<uint8_t> bytes;
    auto word = [&](size_t at, uint32_t value) {
        if (bytes.size() < at + 4) bytes.resize(at + 4);
        for (size_t i = 0; i < 4; ++i) bytes[at + i] = uint8_t(value >> (24 - 8 * i));
    };
    auto text = [&](size_t at, const char *four) {
        word(at, 0);
        std::memcpy(&bytes[at], four, 4);
    };
    const size_t textAt = 132 + 12 * size_t(tags), size = textAt + 16;
    text(textAt, "text");
    text(textAt + 8, "test");
    word(textAt + 12, 0);
    word(0, uint32_t(size));
    word(8, 0x02100000);
    const std::pair<size_t, const char *> kTexts[] = {{12, "mntr"}, {16, "RGB "}, {20, "XYZ "},
                                                      {36, "acsp"}, {48, "IEC "}, {52, "sRGB"}};
    for (auto [at, four] : kTexts) text(at, four);
    for (auto [at, value] : {std::pair<size_t, uint32_t>(68, 0xf6d6), {72, 0x10000}, {76, 0xd32d}}) word(at, value);
    word(128, uint32_t(tags));
    for (int i = 0; i < tags; ++i) {
        const size_t at = 132 + 12 * size_t(i);
        word(at, 0x61000000u + uint32_t(number * tags + i));
        word(at + 4, uint32_t(textAt));
        word(at + 8, 16);
    }
    return bytes;
}

}  // namespace

class ImageThreads : public FolderTest {
  protected:
    std::string WritePng(int number, int tags) {
        const std::string path = Path(std::to_string(number) + ".png");
        const std::vector<uint8_t> profile = Profile(number, tags);
        OIIO::ImageSpec spec(1 + number % 5, 1 + number % 3, 3, OIIO::TypeDesc::UINT8);
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, int(profile.size())), profile.data());
        const std::vector<uint8_t> pixels(spec.image_pixels() * 3, 100);
        auto out = OIIO::ImageOutput::create(path);
        EXPECT_TRUE(out && out->open(path, spec) && out->write_image(OIIO::TypeDesc::UINT8, pixels.data()) &&
                    out->close());
        return path;
    }
};

// Threads that read PNG files with such profiles at the same time could crash the library or make it loop for ever. So
// the test runs in a separate process, which must end by itself in time.
TEST_F(ImageThreads, ReadPngsWithColorProfilesAtOnce) {
    // The process is started afresh, because the threads of the library do not continue in a forked process.
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    constexpr int kFiles = 64, kTags = 300, kThreads = 8;
    std::vector<std::string> paths;
    for (int i = 0; i < kFiles; ++i) paths.push_back(WritePng(i, kTags));
    // The library must decode the profile, or else this test would show nothing.
    auto probe = OIIO::ImageInput::open(WritePng(kFiles * kTags, 1));
    ASSERT_TRUE(probe);
    EXPECT_EQ(probe->spec().get_string_attribute("ICCProfile:model"), "73524742");
    EXPECT_EQ(probe->spec().get_int_attribute("ICCProfile:profile_size"), 160);

    auto readAll = [&] {
        alarm(120);
        std::barrier start(kThreads);
        std::vector<std::jthread> threads;
        for (int t = 0; t < kThreads; ++t)
            threads.emplace_back([&, t] {
                start.arrive_and_wait();
                for (int i = 0; i < kFiles; ++i) {
                    const auto at = size_t((i + t * kFiles / kThreads) % kFiles);
                    if (ReadImage(paths[at]).image.ChannelCount() != 3) _exit(2);
                }
            });
        threads.clear();
        std::filesystem::remove_all(folder_);
        std::exit(0);  // runs the exit handlers of the library, too
    };
    for (int repeat = 0; repeat < 3; ++repeat) EXPECT_EXIT(readAll(), ::testing::ExitedWithCode(0), "");
}

}  // namespace pbrt::test
