#include <cmath>
#include <functional>

#include "pbrt/math/rng.h"
#include "pbrt/samplers/pmj02bn_sampler.h"

namespace pbrt {

namespace {

constexpr int kSize = BlueNoiseMask::Size, kCount = kSize * kSize;

/// Set of chosen pixels, with an energy per pixel that grows near chosen ones.
class Pattern {
  public:
    Pattern() : bell_(kCount), chosen_(kCount, 0), energy_(kCount, 0) {
        constexpr float kSigma = 1.5f;  // pixels, as in Ulichney 1993
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const auto dx = static_cast<float>(std::min(x, kSize - x)),
                           dy = static_cast<float>(std::min(y, kSize - y));
                bell_[y * kSize + x] = std::exp(-(dx * dx + dy * dy) / (2 * kSigma * kSigma));
            }
    }
    bool IsChosen(int pixel) const { return chosen_[pixel] != 0; }
    void Toggle(int pixel) {
        uint8_t &chosen = chosen_[pixel];
        const float sign = chosen ? -1.0f : 1.0f;
        chosen ^= 1;
        const int px = pixel % kSize, py = pixel / kSize;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                energy_[y * kSize + x] += sign * bell_[((y - py) & (kSize - 1)) * kSize + ((x - px) & (kSize - 1))];
    }
    /// Toggles and returns the chosen pixel of highest energy.
    int RemoveTightestCluster() { return ToggleBest(true, std::greater<float>()); }
    /// Toggles and returns the pixel of lowest energy that is not chosen.
    int FillLargestVoid() { return ToggleBest(false, std::less<float>()); }

  private:
    template <class Better>
    int ToggleBest(bool chosen, Better isBetter) {
        int best = -1;
        for (int i = 0; i < kCount; ++i)
            if (IsChosen(i) == chosen && (best < 0 || isBetter(energy_[i], energy_[best]))) best = i;
        Toggle(best);
        return best;
    }
    std::vector<float> bell_;
    std::vector<uint8_t> chosen_;
    std::vector<float> energy_;
};

}  // namespace

BlueNoiseMask::BlueNoiseMask(uint64_t seed) : ranks_(kCount) {
    Pattern pattern;
    Rng rng(seed);
    int count = 0;
    while (count < kCount / 10) {
        const auto pixel = static_cast<int>(rng.UniformInt(kCount));
        if (pattern.IsChosen(pixel)) continue;
        pattern.Toggle(pixel);
        ++count;
    }
    // Distributes the initial pixels evenly.
    for (;;) {
        const int cluster = pattern.RemoveTightestCluster();
        if (pattern.FillLargestVoid() == cluster) break;
    }
    Pattern fewer = pattern;
    for (int rank = count - 1; rank >= 0; --rank) ranks_[fewer.RemoveTightestCluster()] = static_cast<uint16_t>(rank);
    for (int rank = count; rank < kCount; ++rank) ranks_[pattern.FillLargestVoid()] = static_cast<uint16_t>(rank);
}

}  // namespace pbrt
