#include "fuzz/program.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "pbrt/cmd/pbrt/render_job.h"
#include "pbrt/core/error.h"
#include "pbrt/images/image.h"

#ifdef PBRT_FUZZ_LIGHTLAB
#include "ext/lab/lightlab/lightlab.h"
#endif

namespace pbrt::fuzz {

namespace {

void Say(PictureReport &report, PictureReport::State state, const std::string &text = "") {
    report.state = state;
    std::snprintf(report.text.data(), report.text.size(), "%s", text.c_str());
}

int Call(int (*program)(int, char **), std::vector<std::string> arguments) {
    std::vector<char *> argv;
    for (std::string &a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    return program(static_cast<int>(arguments.size()), argv.data());
}

int RunLightlab([[maybe_unused]] const FuzzCase &fuzzCase) {
#ifdef PBRT_FUZZ_LIGHTLAB
    std::vector<std::string> arguments = {"lightlab"};
    arguments.insert(arguments.end(), fuzzCase.arguments.begin(), fuzzCase.arguments.end());
    arguments.insert(arguments.end(),
                     {"--out", kLabFolder, "--cache", kLabFolder, "--no-report", fuzzCase.files.front().name});
    return Call(ext::lab::RunLightlab, arguments);
#else
    return 2;
#endif
}

}  // namespace

void LookAtPicture(const std::string &path, PictureReport &report) {
    using State = PictureReport::State;
    if (!std::filesystem::exists(path)) return Say(report, State::Missing);
    try {
        const ImageFile file = ReadImage(path);
        const Point2i size = file.image.Resolution();
        if (size.x < 1 || size.y < 1) return Say(report, State::WrongSize, fmt::format("{} x {}", size.x, size.y));
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                for (int c = 0; c < file.image.ChannelCount(); ++c)
                    if (!std::isfinite(file.image.Get({x, y}, c)))
                        return Say(report, State::NotFinite, file.image.Channels()[static_cast<size_t>(c)]);
        Say(report, State::Good, fmt::format("{} x {}", size.x, size.y));
    } catch (const UserError &e) {
        Say(report, State::Unreadable, e.what());
    }
}

int RunProgram(const FuzzCase &fuzzCase, PictureReport &report) {
    namespace fs = std::filesystem;
    if (fuzzCase.isLightlab) {
        // Its folder holds the reference before the run, and is no output of the case.
        const bool hasReference = fuzzCase.files.size() > 1;
        fs::create_directory(kLabFolder);
        if (hasReference) fs::copy_file(fuzzCase.files[1].name, fs::path(kLabFolder) / fuzzCase.files[1].name);
        const int status = RunLightlab(fuzzCase);
        if (status == 0) LookAtPicture(fuzzCase.output, report);
        if (hasReference) fs::remove_all(kLabFolder);
        return status;
    }
    std::vector<std::string> arguments = {"pbrt"};
    arguments.insert(arguments.end(), fuzzCase.arguments.begin(), fuzzCase.arguments.end());
    arguments.insert(arguments.end(), {"--outfile", fuzzCase.output, fuzzCase.files.front().name});
    const int status = Call(RunPbrt, arguments);
    if (status == 0) LookAtPicture(fuzzCase.output, report);
    return status;
}

void PrepareProgram(const std::string &folder) {
    // The module of OpenImageIO, which has 260 libraries, and the colour tables.
    const std::string path = (std::filesystem::path(folder) / "prepare.png").string();
    WriteImage(path, Image(PixelFormat::U8, {2, 2}, {"R", "G", "B"}));
    ReadImage(path);
    std::filesystem::remove(path);
    for (const char *space : {"srgb", "dci-p3", "rec2020", "aces2065-1"}) ColorSpace::Find(space);
}

}  // namespace pbrt::fuzz
