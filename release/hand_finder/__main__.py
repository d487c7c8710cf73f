"""Makes the models of divers' hands: `python -m release.hand_finder draw|teach|landmarks|judge`."""

from __future__ import annotations

import argparse
from pathlib import Path

from release.hand_finder.pictures import read_joints, read_pictures, write_pictures


def main() -> None:
    """Run the step that the command line names."""
    parser = argparse.ArgumentParser(prog="python -m release.hand_finder", description=__doc__)
    steps = parser.add_subparsers(dest="step", required=True)
    draw = steps.add_parser("draw", help="draw random stills of divers and box their hands")
    draw.add_argument("folder", type=Path)
    draw.add_argument("--divers", type=int, default=1500, help="two stills each")
    draw.add_argument("--seed", type=int, default=0, help="of the first diver")
    draw.add_argument("--salutes", type=float, default=0.0, help="share of hands that salute")
    joints = steps.add_parser("landmarks", help="teach the hand landmark model gloved hands")
    joints.add_argument("model", type=Path, help="the ONNX file to begin with")
    joints.add_argument("folders", type=Path, nargs="+", help="drawn stills with joints.npz")
    joints.add_argument("--steps", type=int, default=900, help="of 16 crops each")
    joints.add_argument("--seed", type=int, default=0, help="of the crops")
    joints.add_argument("--tips", type=float, default=1.0, help="how much more finger tips count")
    joints.add_argument("--output", type=Path, required=True, help="the ONNX file to write")
    teach = steps.add_parser("teach", help="teach the palm detector, or a finder, further")
    teach.add_argument("detector", type=Path, help="the ONNX file to begin with")
    teach.add_argument("folders", type=Path, nargs="+", help="pictures with boxes.csv")
    teach.add_argument("--without", nargs="*", default=[], help="beginnings of names to leave out")
    teach.add_argument("--steps", type=int, default=800, help="of 16 crops each")
    teach.add_argument("--seed", type=int, default=0, help="of the crops")
    teach.add_argument("--whole", action="store_true", help="teach the first stage too")
    teach.add_argument("--output", type=Path, required=True, help="the ONNX file to write")
    judge = steps.add_parser("judge", help="teach the model of gloved hands to judge what is seen")
    judge.add_argument("model", type=Path, help="the ONNX file to begin with")
    judge.add_argument("folders", type=Path, nargs="+", help="pictures with boxes.csv")
    judge.add_argument("--output", type=Path, required=True, help="the ONNX file to write")
    arguments = parser.parse_args()
    if arguments.step == "draw":
        seeds = range(arguments.seed, arguments.seed + arguments.divers)
        write_pictures(arguments.folder, seeds, arguments.salutes)
    elif arguments.step == "landmarks":
        _teach_landmarks(arguments)
    elif arguments.step == "judge":
        _teach_judgement(arguments)
    else:
        _teach(arguments)


def _teach_landmarks(arguments: argparse.Namespace) -> None:
    """Import PyTorch only now: drawing needs none."""
    from release.hand_finder.landmarks import teach_landmarks

    stills = [still for folder in arguments.folders for still in read_joints(folder)]
    print(f"{len(stills)} stills", flush=True)
    teach_landmarks(
        arguments.model,
        stills,
        arguments.output,
        steps=arguments.steps,
        seed=arguments.seed,
        tips=arguments.tips,
    )


def _teach_judgement(arguments: argparse.Namespace) -> None:
    """Look at the pictures of folders where that was not done yet, and learn from all."""
    from release.hand_finder.judge import teach_judgement, write_looks

    for seed, folder in enumerate(arguments.folders):
        if not (folder / "looks.npz").exists():
            write_looks(folder, arguments.model, seed)
    teach_judgement(arguments.model, arguments.folders, arguments.output)


def _teach(arguments: argparse.Namespace) -> None:
    """Import PyTorch only now: drawing needs none."""
    from release.hand_finder.teaching import teach

    pictures = [
        picture
        for folder in arguments.folders
        for picture in read_pictures(folder, arguments.without)
    ]
    print(f"{len(pictures)} pictures, {sum(len(one.hands) for one in pictures)} hands", flush=True)
    teach(
        arguments.detector,
        pictures,
        arguments.output,
        steps=arguments.steps,
        seed=arguments.seed,
        whole=arguments.whole,
    )


if __name__ == "__main__":
    main()
