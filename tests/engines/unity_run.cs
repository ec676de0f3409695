// Sets a clip up as the importer does, and prints the name and time of each of its events.
// Arguments: frames, frames of a period, then a name and a phase for each event.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Reflection;
using UnityEditor;

public static class UnityRun
{
    public static void Main(string[] given)
    {
        var events = new List<Roundelay.Event>();
        for (int k = 2; k < given.Length; k += 2)
        {
            float phase = float.Parse(given[k + 1], CultureInfo.InvariantCulture);
            events.Add(new Roundelay.Event { name = given[k], phase = phase });
        }
        var playback = new Roundelay.Playback
        {
            frames = int.Parse(given[0]),
            frames_per_period = int.Parse(given[1]),
            root_motion = new Roundelay.RootMotion(),
            events = events.ToArray(),
        };
        var clip = new ModelImporterClipAnimation();
        typeof(Roundelay.RoundelayImporter)
            .GetMethod("SetUp", BindingFlags.Static | BindingFlags.NonPublic)
            .Invoke(null, new object[] { clip, playback });
        foreach (UnityEngine.AnimationEvent one in clip.events)
            Console.WriteLine(
                one.stringParameter + " " + one.time.ToString("R", CultureInfo.InvariantCulture));
    }
}
