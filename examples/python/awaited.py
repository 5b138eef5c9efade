# %% [markdown]
# # A render that is awaited
# An event loop goes on while the device renders. The task is cancelled when the image is good enough; the image is kept.
#
#     python examples/python/awaited.py [-o awaited.png] [--noise 0.1] [--width 240]

# %%
import argparse
import asyncio

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--noise", type=float, default=0.1, help="at which the task is cancelled")
parser.add_argument("--width", type=int, default=240)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own
renderer = claray.Renderer(claray.load("cornell"), width=options.width, height=options.width, spp=4096, report_seconds=0.05)


# %%
async def main() -> None:
    seen: list[claray.RenderProgress] = []
    task = asyncio.create_task(renderer.render_async(seen.append))
    ticks = 0
    while not task.done():
        await asyncio.sleep(0.02)
        ticks += 1
        if seen and 0 < seen[-1]["noise"] < options.noise:
            task.cancel()
            break
    try:
        await task
    except asyncio.CancelledError:
        pass
    print(f"the loop ticked {ticks} times; {seen[-1]['spp']} samples per pixel, noise {seen[-1]['noise']:.3f}")


# %% [markdown]
# In a notebook, where a loop runs already: `await main()`.

# %%
asyncio.run(main())
image = renderer.image(denoise="claray")
image

# %%
if options.output:
    image.save(options.output)
