// Sets loops up as Unity imports them, from the record that lies beside each.
//
// Put this file into a folder named Editor. For Walk_loop.fbx, made by
//     roundelay loop Walk.bvh --for unity
// the record Walk_loop.json must lie beside it (walk.json beside walk.fbx, if -o named that). Clip,
// loop, root motion and events are set when the model is imported, and again whenever it is.

using System;
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

namespace Roundelay
{
    [Serializable]
    public class Event
    {
        public string name;
        public float phase;
    }

    [Serializable]
    public class RootMotion
    {
        public bool in_file;
    }

    [Serializable]
    public class Playback
    {
        public string target;
        public string root_bone;
        public int frames;
        public int frames_per_period;
        public RootMotion root_motion;
        public Event[] events;
    }

    [Serializable]
    public class Cycle
    {
        public string[] files;
        public Playback playback;
    }

    [Serializable]
    public class Record
    {
        public string roundelay;
        public Cycle[] cycles;
    }

    public class RoundelayImporter : AssetPostprocessor
    {
        // What an event calls on the animated object: void OnLoopEvent(string name).
        const string Receiver = "OnLoopEvent";

        void OnPreprocessModel()
        {
            Playback playback = PlaybackOf(assetPath);
            if (playback == null) return;
            var importer = (ModelImporter)assetImporter;
            importer.animationType = ModelImporterAnimationType.Generic;
            importer.useFileScale = true;
            importer.importAnimation = true;
            if (!string.IsNullOrEmpty(playback.root_bone))
                importer.motionNodeName = playback.root_bone;
        }

        void OnPreprocessAnimation()
        {
            Playback playback = PlaybackOf(assetPath);
            if (playback == null) return;
            var importer = (ModelImporter)assetImporter;
            ModelImporterClipAnimation[] clips = importer.defaultClipAnimations;
            foreach (ModelImporterClipAnimation clip in clips) SetUp(clip, playback);
            importer.clipAnimations = clips;
        }

        static void SetUp(ModelImporterClipAnimation clip, Playback playback)
        {
            clip.loopTime = true;
            // The poses meet by themselves: Unity must not bend them.
            clip.loopPose = false;
            bool moves = playback.root_motion.in_file;
            clip.lockRootRotation = !moves;
            clip.lockRootPositionXZ = !moves;
            clip.lockRootHeightY = true;
            clip.keepOriginalOrientation = true;
            clip.keepOriginalPositionXZ = true;
            clip.keepOriginalPositionY = true;
            var events = new List<AnimationEvent>();
            // Events are of one period; their times are shares of the clip, which may hold several.
            for (int period = 0; period * playback.frames_per_period < playback.frames; period++)
                foreach (Event one in playback.events)
                {
                    var made = new AnimationEvent();
                    made.functionName = Receiver;
                    made.stringParameter = one.name;
                    made.time = (one.phase + period) * playback.frames_per_period / playback.frames;
                    events.Add(made);
                }
            clip.events = events.ToArray();
        }

        // What the record beside a model tells of it; null where there is none.
        public static Playback PlaybackOf(string model)
        {
            string folder = Path.GetDirectoryName(model);
            string name = Path.GetFileName(model);
            foreach (string file in Directory.GetFiles(folder, "*.json"))
            {
                Record record = RecordIn(file);
                if (record == null || record.cycles == null) continue;
                foreach (Cycle cycle in record.cycles)
                    if (cycle.files != null && Array.IndexOf(cycle.files, name) >= 0)
                        return cycle.playback;
            }
            return null;
        }

        // Folders hold other files of that type, too: what is no record is passed over.
        static Record RecordIn(string file)
        {
            try
            {
                return JsonUtility.FromJson<Record>(File.ReadAllText(file));
            }
            catch (ArgumentException)
            {
                return null;
            }
        }
    }
}
