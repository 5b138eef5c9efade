// The wave equation on a height field whose rim is at rest, by the explicit scheme of Courant, Friedrichs and Lewy
// (1928): u(t + dt) = 2 u(t) - u(t - dt) + C^2 laplacian u(t), with C = c dt / h.

/// `before` holds the heights one step earlier and becomes those one step later. Products are exact or fused, so that
/// every device and the host round alike.
kernel void step_wave(global const float* now, global float* before, uint side, float courant_squared) {
    const uint i = get_global_id(0), x = i % side, y = i / side;
    if (x == 0 || y == 0 || x + 1 >= side || y + 1 >= side) return;
    const float laplacian = (now[i - 1] + now[i + 1]) + (now[i - side] + now[i + side]) - 4.0f * now[i];
    before[i] = fma(courant_squared, laplacian, 2.0f * now[i] - before[i]);  // mutant: wave-step
}
