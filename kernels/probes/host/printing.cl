// printf of numbers, text and vectors, by one item.
kernel void probe(global const uint* words, global uint* wrong) {
    const int seven = (int)(words[0] & 0) + 7;
    printf("%d %u 0x%x %.2f %s %% %.2v4hlf\n", -seven, 571428571u * seven + 3, 24 + seven, seven - 5.5f, "a text", (float4)(1, 2, 3, seven - 3));
    wrong[0] = 0;
}
