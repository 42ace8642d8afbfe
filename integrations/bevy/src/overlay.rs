//! A small text with counts. Feature `overlay`.

use crate::camera::{PvsCamera, PvsLock, PvsView};
use bevy::prelude::*;
use bevy::text::{TextColor, TextFont};
use bevy::ui::widget::Text;
use bevy::ui::{BackgroundColor, Node, PositionType, UiRect, Val};

/// Shows for each camera with [`PvsCamera`] what was drawn and culled and how long it took, in the upper left corner.
#[derive(Debug, Clone, Copy, Default)]
pub struct PvsOverlayPlugin;

/// The text of the overlay; despawn it, or hide it, to have none.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component, Default, Clone)]
pub struct PvsOverlay;

impl Plugin for PvsOverlayPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PvsOverlay>().add_systems(Startup, spawn).add_systems(Update, write);
    }
}

fn spawn(mut commands: Commands<'_, '_>) {
    commands.spawn((
        PvsOverlay,
        Text::default(),
        TextFont { font_size: bevy::text::FontSize::Px(14.0), ..TextFont::default() },
        TextColor(Color::WHITE),
        // Levels are bright here and dark there.
        BackgroundColor(Color::srgba(0.0, 0.0, 0.0, 0.7)),
        Node {
            position_type: PositionType::Absolute,
            left: Val::Px(8.0),
            top: Val::Px(8.0),
            padding: UiRect::all(Val::Px(4.0)),
            ..Node::default()
        },
    ));
}

fn write(mut texts: Query<&mut Text, With<PvsOverlay>>, cameras: Query<(&PvsCamera, &PvsView, Has<PvsLock>)>) {
    for mut text in &mut texts {
        text.0.clear();
        for (camera, view, is_locked) in &cameras {
            let at: Vec<String> = view.at().iter().map(|cell| cell.to_string()).collect();
            let line = format!(
                "{:?}{}{}  cell {}  sees {} cells\ndrawn {}  culled {}  query {:.0} us, all {:.0} us  {:?}{}\n",
                view.state,
                if camera.culls { "" } else { ", culls nothing" },
                if is_locked { ", locked" } else { "" },
                if at.is_empty() { "-".to_owned() } else { at.join(" ") },
                view.cells().len(),
                view.drawn,
                view.culled,
                view.query.as_secs_f64() * 1e6,
                view.all.as_secs_f64() * 1e6,
                camera.method,
                if view.fell_back { ", fell back" } else { "" },
            );
            text.0.push_str(&line);
        }
        let n_bytes = text.0.trim_end().len();
        text.0.truncate(n_bytes);
    }
}
