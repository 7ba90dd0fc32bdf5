#include "ext/lab/text_output.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/parallel.h"

namespace ext::lab {
using namespace pbrt;
namespace {

/// Text after `key` and `separator` in the first line that starts with the key; empty if none.
std::string ValueInFile(const char *path, const std::string &key, char separator) {
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        size_t at = line.find(separator);
        if (at == std::string::npos) continue;
        return boost::trim_copy_if(line.substr(at + 1), boost::is_any_of(" \t\""));
    }
    return {};
}

}  // namespace

std::string Align(const std::vector<std::vector<std::string>> &rows) {
    std::vector<size_t> width(rows.at(0).size(), 0);
    for (const auto &row : rows)
        for (size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
    std::string text;
    for (const auto &row : rows) {
        for (size_t c = 0; c < row.size(); ++c)
            text += c == 0 ? fmt::format("{:<{}}", row[c], width[c]) : fmt::format("  {:>{}}", row[c], width[c]);
        text += "\n";
    }
    return text;
}

void MakeFolder(const std::string &folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw UserError("{}: {}.", folder, failed.message());
    CheckWritable(folder + "/index.html");
}

std::string EscapeHtml(std::string text) {
    for (const auto &[special, entity] : {std::pair("&", "&amp;"), {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}})
        boost::replace_all(text, special, entity);
    return text;
}

Json DescribeMachine() {
    auto known = [](const std::string &text) { return text.empty() ? Json() : Json(text); };
    const std::string memory = ValueInFile("/proc/meminfo", "MemTotal", ':');
    return {{"cpu", known(ValueInFile("/proc/cpuinfo", "model name", ':'))},
            {"threads", ThreadCount()},
            {"memoryGB", memory.empty() ? Json() : Json(double(std::atoll(memory.c_str()) / 100000) / 10)},
            {"os", known(ValueInFile("/etc/os-release", "PRETTY_NAME", '='))}};
}

std::string DateText() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

}  // namespace ext::lab
