#include "pbrt/textures/noise.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace pbrt {
namespace {

/// Permutation of 0-255 of the reference implementation (Perlin, Improving Noise, SIGGRAPH 2002).
constexpr std::array<uint8_t, 256> kPermutation = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180};

static_assert([](std::array<uint8_t, 256> values) {
    std::ranges::sort(values);
    return std::ranges::adjacent_find(values) == values.end();
}(kPermutation));

/// Gradients per hash: from a cube's centre to the middles of its 12 edges, four of them twice.
constexpr int8_t kGradients[16][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                                      {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
                                      {1, 1, 0},  {-1, 1, 0},  {0, 1, -1}, {0, -1, -1}};

constexpr Float kLacunarity = Float(1.99);
/// Mean of |noise|, for octaves too fine for the footprint.
constexpr Float kMeanMagnitude = Float(0.2);

uint8_t Permute(int i) { return kPermutation[i & 255]; }

Vector3 LatticeGradient(const glm::ivec3 &cell) {
    const int hash = Permute(Permute(Permute(cell.x) + cell.y) + cell.z) & 15;
    const int8_t *g = kGradients[hash];
    return Vector3(g[0], g[1], g[2]);
}

/// Quintic from 0 to 1 with two vanishing derivatives at both ends.
Float Fade(Float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
Float FadeSlope(Float t) { return 30 * Sqr(t * (t - 1)); }

/// Lattice cell and position in it, in [0, 1]^3.
struct LatticePlace {
    glm::ivec3 cell;
    Vector3 d;

    explicit LatticePlace(const Point3 &p) {
        const Point3 low = glm::floor(p);
        auto whole = [](Float v) { return std::abs(v) < Float(1 << 30) ? int(v) : 0; };
        cell = {whole(low.x), whole(low.y), whole(low.z)};
        d = p - low;
    }
};

/// Number of octaves within the footprint's resolution, and the fraction of the next.
struct VisibleOctaves {
    int whole;
    Float part;

    VisibleOctaves(int count, const Vector3 &dpdx, const Vector3 &dpdy) {
        // The finest octave kept has features about two footprints apart.
        const Float squared = std::max(LengthSquared(dpdx), LengthSquared(dpdy));
        const Float n = std::clamp(-1 - std::log2(squared) / 2, Float(0), Float(count));
        whole = int(n);
        part = glm::smoothstep(Float(0.3), Float(0.7), n - std::floor(n));
    }
};

}  // namespace

Float GradientNoise(const Point3 &p) {
    const auto [cell, d] = LatticePlace(p);
    Float heights[8];
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1, (i >> 1) & 1, i >> 2);
        heights[i] = Dot(LatticeGradient(cell + corner), d - Vector3(corner));
    }
    const Vector3 w(Fade(d.x), Fade(d.y), Fade(d.z));
    Float y[2];
    for (int k = 0; k < 2; ++k)
        y[k] =
            Lerp(w.y, Lerp(w.x, heights[4 * k], heights[4 * k + 1]), Lerp(w.x, heights[4 * k + 2], heights[4 * k + 3]));
    return Lerp(w.z, y[0], y[1]);
}

Vector3 GradientNoiseSlope(const Point3 &p) {
    const auto [cell, d] = LatticePlace(p);
    const Vector3 fade(Fade(d.x), Fade(d.y), Fade(d.z));
    const Vector3 fadeSlope(FadeSlope(d.x), FadeSlope(d.y), FadeSlope(d.z));
    Vector3 sum(0);
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1, (i >> 1) & 1, i >> 2);
        const Vector3 g = LatticeGradient(cell + corner);
        const Float height = Dot(g, d - Vector3(corner));
        Vector3 w, slope;
        for (int a = 0; a < 3; ++a) {
            w[a] = corner[a] ? fade[a] : 1 - fade[a];
            slope[a] = corner[a] ? fadeSlope[a] : -fadeSlope[a];
        }
        sum += g * (w.x * w.y * w.z) + height * Vector3(slope.x * w.y * w.z, w.x * slope.y * w.z, w.x * w.y * slope.z);
    }
    return sum;
}

Float NoiseOctaves::Signed(const Point3 &p, const Vector3 &dpdx, const Vector3 &dpdy) const {
    const VisibleOctaves visible(count, dpdx, dpdy);
    Float sum = 0, frequency = 1, strength = 1;
    for (int i = 0; i < visible.whole; ++i) {
        sum += strength * GradientNoise(frequency * p);
        frequency *= kLacunarity;
        strength *= roughness;
    }
    if (visible.part > 0) sum += strength * visible.part * GradientNoise(frequency * p);
    return sum;
}

Float NoiseOctaves::Creased(const Point3 &p, const Vector3 &dpdx, const Vector3 &dpdy) const {
    const VisibleOctaves visible(count, dpdx, dpdy);
    Float sum = 0, frequency = 1, strength = 1;
    for (int i = 0; i < visible.whole; ++i) {
        sum += strength * std::abs(GradientNoise(frequency * p));
        frequency *= kLacunarity;
        strength *= roughness;
    }
    // The faded octave blends with its mean. The loop below counts it again as a mean, as in stock pbrt-v4.
    sum += strength * Lerp(visible.part, kMeanMagnitude, std::abs(GradientNoise(frequency * p)));
    for (int i = visible.whole; i < count; ++i) {
        sum += strength * kMeanMagnitude;
        strength *= roughness;
    }
    return sum;
}

}  // namespace pbrt
