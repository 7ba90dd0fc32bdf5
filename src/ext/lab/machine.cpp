#include "ext/lab/machine.h"

#include <ctime>
#include <fstream>

#include "pbrt/core/parallel.h"

namespace pbrt::lab {

namespace {

/// What follows `key` and `separator` in the first line of a file that starts with the key; empty if there is none.
std::string ValueInFile(const char *path, const std::string &key, char separator) {
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        size_t at = line.find(separator);
        if (at == std::string::npos) continue;
        std::string value = line.substr(at + 1);
        value.erase(0, value.find_first_not_of(" \t\""));
        value.erase(value.find_last_not_of(" \t\"") + 1);
        return value;
    }
    return {};
}

}  // namespace

nlohmann::ordered_json DescribeMachine() {
    auto known = [](const std::string &text) {
        return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
    };
    nlohmann::ordered_json machine;
    machine["cpu"] = known(ValueInFile("/proc/cpuinfo", "model name", ':'));
    machine["threads"] = ThreadCount();
    std::string memory = ValueInFile("/proc/meminfo", "MemTotal", ':');
    machine["memoryGB"] = nullptr;
    if (!memory.empty()) machine["memoryGB"] = static_cast<double>(std::atoll(memory.c_str()) / 100000) / 10;
    machine["os"] = known(ValueInFile("/etc/os-release", "PRETTY_NAME", '='));
    return machine;
}

std::string DateText() {
    std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

}  // namespace pbrt::lab
