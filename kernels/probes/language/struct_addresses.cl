// Functions that are not inlined read and write structs of their caller by address.
typedef struct {
    float3 at;
    uint count;
    uchar bytes[5];
    ulong sum;
    float4 plane;
} State;
typedef struct {
    State states[3];
    uint chosen;
} Outer;

__attribute__((noinline)) uint read_from(const State* s) { return (uint)s->at.y + s->count + s->bytes[s->count % 5] + (uint)s->sum + (uint)s->plane.w; }
__attribute__((noinline)) void write_to(State* s, uint word) {
    s->at = (float3)(1, word & 255, 3);
    s->count = word >> 8 & 255;
    for (uint k = 0; k < 5; ++k) s->bytes[k] = (uchar)(word >> k);
    s->sum = (ulong)word << 32 | 7;
    s->plane = (float4)(1, 2, 3, word >> 16 & 255);
}
__attribute__((noinline)) uint read_chosen(const Outer* o) { return read_from(&o->states[o->chosen]); }
__attribute__((noinline)) void swap_numbers(uint* a, uint* b) {
    const uint kept = *a;
    *a = *b, *b = kept;
}

uint expected(uint word) { return (word & 255) + (word >> 8 & 255) + (word >> (word >> 8 & 255) % 5 & 255) + 7 + (word >> 16 & 255); }

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    State one = {(float3)(4, 5, 6), words[i] & 3, {1, 2, 3, 4, 5}, 100, (float4)(0, 0, 0, 9)};
    uint bad = read_from(&one) != 5 + (words[i] & 3) + 1 + (words[i] & 3) + 100 + 9;
    write_to(&one, words[i]);
    bad += read_from(&one) != expected(words[i]) || one.sum >> 32 != words[i] || one.at.z != 3;
    Outer outer;
    for (uint k = 0; k < 3; ++k) write_to(&outer.states[k], words[i + k + 1]);
    for (outer.chosen = 0; outer.chosen < 3; ++outer.chosen) bad += read_chosen(&outer) != expected(words[i + outer.chosen + 1]);
    uint a = words[i], b = words[i + 1];
    swap_numbers(&a, &b);
    wrong[i] = bad + (a != words[i + 1] || b != words[i]);
}
