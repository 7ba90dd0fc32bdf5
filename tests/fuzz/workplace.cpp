#include "fuzz/workplace.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "pbrt/cmd/pbrt/render_job.h"
#include "pbrt/core/error.h"
#include "pbrt/images/image.h"

#ifdef PBRT_FUZZ_LIGHTLAB
#include "ext/lab/lightlab/lightlab.h"
#endif

namespace pbrt::fuzz {

namespace fs = std::filesystem;

namespace {

void SetBad(PictureReport &report, const std::string &text) {
    report.state = PictureReport::State::Bad;
    std::snprintf(report.text.data(), report.text.size(), "%s", text.c_str());
}

/// Calls a program with the case's arguments, these, and the scene.
int Call(int (*program)(int, char **), const char *name, const FuzzCase &fuzzCase,
         const std::vector<std::string> &more) {
    std::vector<std::string> arguments = {name};
    arguments.insert(arguments.end(), fuzzCase.arguments.begin(), fuzzCase.arguments.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.push_back(fuzzCase.files.front().name);
    std::vector<char *> argv;
    for (std::string &a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    return program(int(arguments.size()), argv.data());
}

int RunLightlab([[maybe_unused]] const FuzzCase &fuzzCase) {
#ifdef PBRT_FUZZ_LIGHTLAB
    return Call(ext::lab::RunLightlab, "lightlab", fuzzCase,
                {"--out", kLabFolder, "--cache", kLabFolder, "--no-report"});
#else
    return 2;
#endif
}

}  // namespace

void CheckImage(const std::string &path, PictureReport &report) {
    if (!fs::exists(path)) return;
    using State = PictureReport::State;
    report.state = State::Good;
    try {
        const Image image = ReadImage(path).image;
        if (image.ValueCount() == 0) SetBad(report, "no pixels");
        ForEachValue(image, [&](Point2i p, int c) {
            if (report.state == State::Good && !std::isfinite(image.Get(p, c)))
                SetBad(report, "not finite: " + image.Channels()[c]);
        });
    } catch (const UserError &e) {
        SetBad(report, std::string("unreadable: ") + e.what());
    }
}

int RunProgram(const FuzzCase &fuzzCase, PictureReport &report) {
    // Lightlab's folder holds the reference before the run, and is no output of the case.
    const bool hasReference = fuzzCase.isLightlab && fuzzCase.files.size() > 1;
    if (fuzzCase.isLightlab) fs::create_directory(kLabFolder);
    if (hasReference) fs::copy_file(fuzzCase.files[1].name, fs::path(kLabFolder) / fuzzCase.files[1].name);
    const int status =
        fuzzCase.isLightlab ? RunLightlab(fuzzCase) : Call(RunPbrt, "pbrt", fuzzCase, {"--outfile", fuzzCase.output});
    if (status == 0) CheckImage(fuzzCase.output, report);
    if (hasReference) fs::remove_all(kLabFolder);
    return status;
}

void PrepareProgram(const std::string &folder) {
    // The module of OpenImageIO, which has 260 libraries, and the colour tables.
    const std::string path = (fs::path(folder) / "prepare.png").string();
    WriteImage(path, Image(PixelFormat::U8, {2, 2}, {"R", "G", "B"}));
    ReadImage(path);
    fs::remove(path);
    for (const char *space : {"srgb", "dci-p3", "rec2020", "aces2065-1"}) ColorSpace::Find(space);
}

void WriteFiles(const FuzzCase &fuzzCase, const std::string &folder) {
    for (const CaseFile &file : fuzzCase.files)
        std::ofstream(fs::path(folder) / file.name, std::ios::binary)
            .write(file.bytes.data(), std::streamsize(file.bytes.size()));
}

Workplace::Workplace(std::string folder, Program program) : folder_(std::move(folder)), program_(std::move(program)) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
}

void Workplace::Start(const FuzzCase &fuzzCase, const Limits &limits) {
    case_ = fuzzCase;
    WriteFiles(case_, folder_);
    child_.Start(
        folder_, [this](PictureReport &report) { return program_(case_, report); }, limits);
}

std::optional<CaseResult> Workplace::Poll(int milliseconds) {
    if (!child_.Poll(milliseconds)) return {};
    CaseResult result;
    result.run = child_.Take();
    std::vector<std::string> left;
    for (const CaseFile &file : case_.files) fs::remove(fs::path(folder_) / file.name);
    for (const auto &entry : fs::directory_iterator(folder_)) {
        left.push_back(entry.path().filename().string());
        fs::remove_all(entry.path());
    }
    result.verdict = Judge(result.run, case_, left);
    return result;
}

CaseResult Workplace::Run(const FuzzCase &fuzzCase, const Limits &limits) {
    Start(fuzzCase, limits);
    for (;;)
        if (auto result = Poll(20)) return *std::move(result);
}

}  // namespace pbrt::fuzz
