// Writes smoke.nvdb: the density and the temperature of a fire's plume that the wind bends, on a grid of 5 cm.
//   g++ -std=c++17 -O2 -DNANOVDB_USE_ZIP make_grid.cpp -lz -o make_grid && ./make_grid smoke.nvdb
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

#include <cmath>
#include <cstdint>

namespace {

/// A number in [0, 1) for a point of a lattice.
double LatticeNumber(int x, int y, int z, int layer) {
    uint32_t h = uint32_t(x) * 0x8da6b343u ^ uint32_t(y) * 0xd8163841u ^ uint32_t(z) * 0xcb1ab31fu ^ uint32_t(layer) * 0x165667b1u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return (h ^ (h >> 15)) / 4294967296.0;
}

/// Smooth noise in [0, 1] whose features have the size 1.
double Noise(double x, double y, double z, int layer) {
    const double p[3] = {x, y, z};
    int low[3];
    double f[3];
    for (int a = 0; a < 3; ++a) {
        low[a] = int(std::floor(p[a]));
        f[a] = p[a] - low[a];
        f[a] = f[a] * f[a] * (3 - 2 * f[a]);
    }
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const int d[3] = {i & 1, i >> 1 & 1, i >> 2};
        double w = 1;
        for (int a = 0; a < 3; ++a) w *= d[a] ? f[a] : 1 - f[a];
        sum += w * LatticeNumber(low[0] + d[0], low[1] + d[1], low[2] + d[2], layer);
    }
    return sum;
}

double Turbulence(double x, double y, double z) {
    return (Noise(x, y, z, 0) + Noise(2 * x, 2 * y, 2 * z, 1) / 2 + Noise(4 * x, 4 * y, 4 * z, 2) / 4) / 1.75;
}

}  // namespace

int main(int argc, char **argv) {
    if (argc != 2) return 1;
    constexpr double kVoxel = 0.05, kHeight = 3.6;
    nanovdb::GridBuilder<float> density(0.f, nanovdb::GridClass::FogVolume), heat(0.f, nanovdb::GridClass::FogVolume);
    auto densities = density.getAccessor(), temperatures = heat.getAccessor();
    for (int k = 0; k < int(kHeight / kVoxel); ++k)
        for (int j = -20; j <= 20; ++j)
            for (int i = -16; i <= 44; ++i) {
                const double x = i * kVoxel, y = j * kVoxel, z = k * kVoxel;
                const double bend = .12 * z * z, radius = .22 + .17 * z;
                const double turbulence = Turbulence(3 * x, 3 * y, 3 * z - 2);
                const double r = std::hypot(x - bend, y) / radius, thick = 1 - r * r + 1.6 * (turbulence - .5);
                if (!(thick > 0)) continue;
                const double fade = std::fmin(1, (kHeight - z) / 1.2) * std::fmin(1, z / .15 + .2);
                densities.setValue({i, j, k}, float(std::fmin(thick, 1) * fade / (1 + .8 * z)));
                const double kelvin = 2100 * thick * std::exp(-std::pow(z / .75, 2)) + 300;
                if (kelvin > 600) temperatures.setValue({i, j, k}, float(std::round(std::fmin(kelvin, 2100))));
            }
    std::vector<nanovdb::GridHandle<>> grids;
    grids.push_back(density.getHandle<>(kVoxel, nanovdb::Vec3d(0), "density"));
    grids.push_back(heat.getHandle<>(kVoxel, nanovdb::Vec3d(0), "temperature"));
    nanovdb::io::writeGrids(argv[1], grids, nanovdb::io::Codec::ZIP);
}
