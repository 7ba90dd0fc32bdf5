#include "fuzz/workplace.h"

#include <poll.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace pbrt::fuzz {

namespace fs = std::filesystem;

void WriteFiles(const FuzzCase &fuzzCase, const std::string &folder) {
    for (const CaseFile &file : fuzzCase.files)
        std::ofstream(fs::path(folder) / file.name, std::ios::binary)
            .write(file.bytes.data(), static_cast<std::streamsize>(file.bytes.size()));
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

std::optional<CaseResult> Workplace::Poll() {
    if (!child_.Poll()) return {};
    CaseResult result;
    result.run = child_.Take();
    std::vector<std::string> left;
    for (const auto &entry : fs::directory_iterator(folder_)) {
        const std::string name = entry.path().filename().string();
        if (std::none_of(case_.files.begin(), case_.files.end(), [&](const CaseFile &f) { return f.name == name; })) {
            left.push_back(name);
            fs::remove_all(entry.path());
        }
    }
    for (const CaseFile &file : case_.files) fs::remove(fs::path(folder_) / file.name);
    result.verdict = Judge(result.run, case_, left);
    return result;
}

CaseResult Workplace::Run(const FuzzCase &fuzzCase, const Limits &limits) {
    Start(fuzzCase, limits);
    for (;;) {
        pollfd end{EndDescriptor(), POLLIN, 0};
        poll(&end, 1, 20);
        if (auto result = Poll()) return *std::move(result);
    }
}

}  // namespace pbrt::fuzz
