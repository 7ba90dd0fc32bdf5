#include "pbrt/core/temporaries.h"

#include <filesystem>
#include <mutex>
#include <set>

namespace pbrt {

namespace {

struct Registry {
    std::mutex mutex;
    std::multiset<std::string> paths;
};

/// Leaked: a signal may come during process exit.
Registry &Registered() {
    static auto *registry = new Registry;
    return *registry;
}

}  // namespace

Temporary::Temporary(std::string path) : path_(std::move(path)) {
    Registry &r = Registered();
    std::lock_guard lock(r.mutex);
    r.paths.insert(path_);
}

Temporary::~Temporary() {
    Registry &r = Registered();
    std::lock_guard lock(r.mutex);
    r.paths.erase(r.paths.find(path_));
}

void RemoveTemporaries() {
    Registry &r = Registered();
    r.mutex.lock();
    std::error_code ignored;
    for (const std::string &path : r.paths) std::filesystem::remove_all(path, ignored);
}

}  // namespace pbrt
