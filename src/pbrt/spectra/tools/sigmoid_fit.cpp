#include "pbrt/spectra/tools/sigmoid_fit.h"

#include <cmath>

namespace pbrt {
namespace {

constexpr double kMaxCoefficient = 200;
constexpr int kMaxIterations = 15;
constexpr double kGoodEnough = 1e-10;  // squared CIELAB distance
// As for stock pbrt-v4's tables: 5 nm steps with three nodes each. Summing whole nanometres differs by up to 0.4 % in
// dark channels of saturated colours.
constexpr int kStep = 5, kSteps = 470 / kStep, kIntervals = 3 * kSteps;
constexpr size_t kVectorLength = 8;

bool Solve3(const double a[3][3], const double b[3], double x[3]) {
    double c00 = a[1][1] * a[2][2] - a[1][2] * a[2][1], c01 = a[1][2] * a[2][0] - a[1][0] * a[2][2];
    double c02 = a[1][0] * a[2][1] - a[1][1] * a[2][0];
    double determinant = a[0][0] * c00 + a[0][1] * c01 + a[0][2] * c02;
    if (!(std::abs(determinant) > 1e-300)) return false;
    double inverse = 1 / determinant;
    x[0] = inverse * (b[0] * c00 + b[1] * (a[0][2] * a[2][1] - a[0][1] * a[2][2]) +
                      b[2] * (a[0][1] * a[1][2] - a[0][2] * a[1][1]));
    x[1] = inverse * (b[0] * c01 + b[1] * (a[0][0] * a[2][2] - a[0][2] * a[2][0]) +
                      b[2] * (a[0][2] * a[1][0] - a[0][0] * a[1][2]));
    x[2] = inverse * (b[0] * c02 + b[1] * (a[0][1] * a[2][0] - a[0][0] * a[2][1]) +
                      b[2] * (a[0][0] * a[1][1] - a[0][1] * a[1][0]));
    return true;
}

double AtTableStep(const Spectrum &s, double position) {
    double x = position * kSteps;
    int i = std::min(int(x), kSteps - 1);
    double t = x - i;
    auto at = [&](int k) { return double(s(LambdaMin + Float(k * kStep))); };
    return at(i) * (1 - t) + at(i + 1) * t;
}

}  // namespace

SigmoidFit::SigmoidFit(const RgbPrimaries &space) {
    SpectrumPtr illuminant = NamedSpectrum(space.illuminant);
    const DenseSpectrum *matching[3] = {&CieX(), &CieY(), &CieZ()};
    double sumY = 0;
    for (int i = 0; i <= kIntervals; ++i) {
        double position = double(i) / kIntervals;
        double rule = i == 0 || i == kIntervals ? 1 : i % 3 == 0 ? 2 : 3;  // Simpson's 3/8, up to a factor
        double emitted = rule * AtTableStep(*illuminant, position);
        weights_.position.push_back(position);
        for (size_t k = 0; k < 3; ++k) weights_.weights[k].push_back(emitted * AtTableStep(*matching[k], position));
        sumY += weights_.weights[1].back();
    }
    for (std::vector<double> &list : weights_.weights)
        for (double &w : list) w /= sumY;
    while (weights_.position.size() % kVectorLength != 0) {
        weights_.position.push_back(0);
        for (std::vector<double> &w : weights_.weights) w.push_back(0);
    }
    for (size_t k = 0; k < 3; ++k) {
        white_[k] = 0;
        for (double w : weights_.weights[k]) white_[k] += w;
    }
    Vector3 white(static_cast<Float>(white_[0]), static_cast<Float>(white_[1]), static_cast<Float>(white_[2]));
    xyzFromRgb_ = glm::dmat3(ComputeXyzFromRgb(space.r, space.g, space.b, white));
}

void SigmoidFit::Lab(const double xyz[3], double lab[3], double derivative[3]) const {
    constexpr double delta = 6.0 / 29;
    double f[3];
    for (int k = 0; k < 3; ++k) {
        double t = xyz[k] / white_[k];
        if (t > delta * delta * delta) {
            f[k] = std::cbrt(t);
            derivative[k] = 1 / (3 * f[k] * f[k] * white_[k]);
        } else {
            f[k] = t / (3 * delta * delta) + 4.0 / 29;
            derivative[k] = 1 / (3 * delta * delta * white_[k]);
        }
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

double SigmoidFit::Residual(const double c[3], const double target[3], double r[3], double jacobian[3][3]) const {
    SigmoidIntegrals integrals;
    IntegrateSigmoid(weights_, c, &integrals);
    double lab[3], d[3];
    Lab(integrals.xyz, lab, d);
    for (int k = 0; k < 3; ++k) r[k] = target[k] - lab[k];
    for (int j = 0; j < 3; ++j) {
        double fx = d[0] * integrals.jacobian[0][j], fy = d[1] * integrals.jacobian[1][j];
        double fz = d[2] * integrals.jacobian[2][j];
        jacobian[0][j] = 116 * fy;
        jacobian[1][j] = 500 * (fx - fy);
        jacobian[2][j] = 200 * (fy - fz);
    }
    return r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
}

double SigmoidFit::Fit(const double rgb[3], double c[3]) const {
    glm::dvec3 xyz = xyzFromRgb_ * glm::dvec3(rgb[0], rgb[1], rgb[2]);
    double target[3], unused[3];
    const double xyzArray[3] = {xyz.x, xyz.y, xyz.z};
    Lab(xyzArray, target, unused);

    double error = 0;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        double r[3], jacobian[3][3], step[3];
        error = Residual(c, target, r, jacobian);
        if (error < kGoodEnough || !Solve3(jacobian, r, step)) break;
        if (!std::isfinite(step[0] + step[1] + step[2])) break;
        for (int j = 0; j < 3; ++j) c[j] += step[j];
        if (double largest = std::max({c[0], c[1], c[2]}); largest > kMaxCoefficient)
            for (int j = 0; j < 3; ++j) c[j] *= kMaxCoefficient / largest;
    }
    return std::sqrt(error);
}

void SigmoidFit::ToNanometres(const double c[3], float out[3]) {
    constexpr double low = double(LambdaMin), s = 1 / (double(LambdaMax) - double(LambdaMin));
    out[0] = float(c[0] * s * s);
    out[1] = float(c[1] * s - 2 * c[0] * low * s * s);
    out[2] = float(c[2] - c[1] * low * s + c[0] * low * low * s * s);
}

}  // namespace pbrt
