#include "pbrt/math/catmull_rom.h"

namespace pbrt {

std::optional<SplineWeights> CatmullRomWeights(std::span<const Float> nodes, Float x) {
    if (!(x >= nodes.front() && x <= nodes.back())) return {};
    const int n = int(nodes.size());
    auto node = [&](int k) { return nodes[k]; };
    const int i = FindPiece(n, node, x);
    const Float width = nodes[i + 1] - nodes[i], t = (x - nodes[i]) / width;
    const Float t2 = t * t, t3 = t2 * t;
    SplineWeights weights;
    weights.first = std::clamp(i - 1, 0, n - 4);
    auto weight = [&](int k) -> Float & { return weights.w[k - weights.first]; };
    weight(i) += 2 * t3 - 3 * t2 + 1;
    weight(i + 1) += 3 * t2 - 2 * t3;
    auto addSlope = [&](Float basis, int from, int to) {
        const Float w = basis * width / (nodes[to] - nodes[from]);
        weight(to) += w;
        weight(from) -= w;
    };
    addSlope(t3 - 2 * t2 + t, std::max(i - 1, 0), i + 1);
    addSlope(t3 - t2, i, std::min(i + 2, n - 1));
    return weights;
}

Float IntegrateCatmullRom(std::span<const Float> nodes, std::span<const Float> values, std::span<Float> cdf) {
    Float sum = 0;
    cdf[0] = 0;
    for (int i = 0; i + 1 < int(nodes.size()); ++i)
        cdf[i + 1] = sum += CatmullRomPiece(nodes, i, [&](int k) { return values[k]; }).Integral(1);
    return sum;
}

Float InvertCatmullRom(std::span<const Float> nodes, std::span<const Float> values, Float y) {
    if (!(y > values.front())) return nodes.front();
    if (!(y < values.back())) return nodes.back();
    auto value = [&](int k) { return values[k]; };
    const SplinePiece piece = CatmullRomPiece(nodes, FindPiece(int(nodes.size()), value, y), value);
    const Float t = SolveIncreasing([&](Float s) { return piece.Value(s); }, [&](Float s) { return piece.Slope(s); }, y,
                                    Float(1e-6) * values.back());
    return piece.x + piece.width * t;
}

}  // namespace pbrt
