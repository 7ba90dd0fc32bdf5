#include "pbrt/lights/light_spectrum.h"

#include <mutex>
#include <unordered_map>

#include "pbrt/math/rng.h"

namespace pbrt {

std::shared_ptr<const DenseSpectrum> InternSpectrum(const Spectrum &s) {
    static std::mutex mutex;
    static std::unordered_map<uint64_t, std::weak_ptr<const DenseSpectrum>> known;

    auto dense = std::make_shared<const DenseSpectrum>(s);
    uint64_t hash = 0;
    auto forEachNanometre = [](auto f) {
        for (int nm = int(LambdaMin); nm <= int(LambdaMax); ++nm)
            if (!f(Float(nm))) return false;
        return true;
    };
    forEachNanometre([&](Float nm) {
        hash = Hash(hash, (*dense)(nm));
        return true;
    });

    std::lock_guard lock(mutex);
    std::weak_ptr<const DenseSpectrum> &slot = known[hash];
    if (std::shared_ptr<const DenseSpectrum> old = slot.lock()) {
        bool equal = forEachNanometre([&](Float nm) { return (*old)(nm) == (*dense)(nm); });
        return equal ? old : dense;
    }
    slot = dense;
    return dense;
}

}  // namespace pbrt
