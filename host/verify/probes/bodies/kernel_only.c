static void probe(Probe* p) {
    build(p, ""), prepare(p), launch(p, 16384, 64);
}
