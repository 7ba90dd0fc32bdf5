#include <cmath>

#include "pbrt/spectra/tools/sigmoid_fit.h"

namespace pbrt {

void IntegrateSigmoid(const ReflectanceWeights &w, const double c[3], SigmoidIntegrals *result) {
    const double *__restrict t = w.position.data();
    const double *__restrict wx = w.weights[0].data(), *__restrict wy = w.weights[1].data();
    const double *__restrict wz = w.weights[2].data();
    const double c0 = c[0], c1 = c[1], c2 = c[2];
    double x = 0, y = 0, z = 0;
    double x0 = 0, x1 = 0, x2 = 0, y0 = 0, y1 = 0, y2 = 0, z0 = 0, z1 = 0, z2 = 0;
    const auto n = long(w.position.size());
    for (long i = 0; i < n; ++i) {
        double p = (c0 * t[i] + c1) * t[i] + c2;
        double q = 1 / std::sqrt(1 + p * p);
        double s = 0.5 + 0.5 * p * q;
        double d2 = 0.5 * q * q * q, d1 = d2 * t[i], d0 = d1 * t[i];
        x += wx[i] * s;
        y += wy[i] * s;
        z += wz[i] * s;
        x0 += wx[i] * d0;
        x1 += wx[i] * d1;
        x2 += wx[i] * d2;
        y0 += wy[i] * d0;
        y1 += wy[i] * d1;
        y2 += wy[i] * d2;
        z0 += wz[i] * d0;
        z1 += wz[i] * d1;
        z2 += wz[i] * d2;
    }
    *result = {{x, y, z}, {{x0, x1, x2}, {y0, y1, y2}, {z0, z1, z2}}};
}

}  // namespace pbrt
