// Quantiles of the raw noises over their texels, by which the baked volumes are made uniform on [0, 1]: the part RANKS of
// all texels lies below the value of the same place.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_NOISE_QUANTILES_H
#define TYNDALL_SHADERS_VOLUMETRICS_NOISE_QUANTILES_H

#define TYNDALL_NOISE_QUANTILE_COUNT 23
// clang-format off
#define TYNDALL_NOISE_RANKS \
    0.0, 0.0009765625, 0.00390625, 0.015625, 0.0625, 0.125, 0.1875, 0.25, 0.3125, 0.375, 0.4375, 0.5, \
    0.5625, 0.625, 0.6875, 0.75, 0.8125, 0.875, 0.9375, 0.984375, 0.99609375, 0.9990234375, 1.0
#define TYNDALL_SHAPE_QUANTILES \
    0.4143, 0.5085, 0.5398, 0.5801, 0.6285, 0.6586, 0.6791, 0.6956, 0.7095, 0.7218, 0.7334, 0.7446, \
    0.7557, 0.7669, 0.7786, 0.7915, 0.8058, 0.8223, 0.8449, 0.8772, 0.8997, 0.9144, 0.9619
#define TYNDALL_DETAIL_QUANTILES \
    0.0330, 0.0832, 0.1407, 0.2065, 0.2813, 0.3276, 0.3594, 0.3883, 0.4123, 0.4347, 0.4561, 0.4774, \
    0.4978, 0.5188, 0.5412, 0.5659, 0.5944, 0.6274, 0.6772, 0.7459, 0.8018, 0.8450, 0.9120
// clang-format on

#endif
