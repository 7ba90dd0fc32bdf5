#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

namespace pbrt {

/// Table T::Compute(arguments...) shared by all callers with equal arguments, freed with its last owner.
template <class T, class... Args>
std::shared_ptr<const T> SharedTable(const Args &...arguments) {
    static std::mutex mutex;
    static std::map<std::tuple<Args...>, std::weak_ptr<const T>> tables;
    const std::tuple key(arguments...);
    {
        std::lock_guard lock(mutex);
        if (std::shared_ptr<const T> table = tables[key].lock()) return table;
    }
    // Without the lock, because a thread waiting for its loop may run another caller's task.
    auto table = std::make_shared<const T>(T::Compute(arguments...));
    std::lock_guard lock(mutex);
    if (std::shared_ptr<const T> other = tables[key].lock()) return other;
    tables[key] = table;
    return table;
}

}  // namespace pbrt
