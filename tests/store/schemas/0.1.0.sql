-- A library of version 0.1.0, written by its own tables, with a row of every kind.
BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0005');
CREATE TABLE clip (
	id VARCHAR(32) NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	media_type VARCHAR(64) NOT NULL, 
	size INTEGER NOT NULL, 
	width INTEGER NOT NULL, 
	height INTEGER NOT NULL, 
	duration FLOAT, 
	frames INTEGER, 
	idempotency_key VARCHAR(255), 
	created DATETIME NOT NULL, 
	deleted DATETIME, topics TEXT DEFAULT '[]' NOT NULL, topic VARCHAR(255), keypoints TEXT, 
	PRIMARY KEY (id), 
	UNIQUE (idempotency_key)
);
INSERT INTO "clip" VALUES('cccccccccccccccccccccccccccccccc','dive ''one''.mp4','video/mp4',1234,640,480,2.5,50,'key-1','2026-01-02 03:04:05.678901',NULL,'[]',NULL,NULL);
INSERT INTO "clip" VALUES('dddddddddddddddddddddddddddddddd','gone.mp4','video/mp4',1234,640,480,NULL,NULL,NULL,'2026-01-02 03:04:05.678901','2026-01-03 00:00:00.000000','[]',NULL,NULL);
CREATE TABLE demonstration_source (
	trajectory VARCHAR(64) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	start FLOAT NOT NULL, 
	"end" FLOAT NOT NULL, 
	keep_transit BOOLEAN NOT NULL, 
	PRIMARY KEY (trajectory), 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE
);
INSERT INTO "demonstration_source" VALUES('ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff','cccccccccccccccccccccccccccccccc',0.5,1.5,0);
CREATE TABLE job (
	id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	client VARCHAR(64) NOT NULL, 
	status VARCHAR(16) NOT NULL, 
	attempts INTEGER NOT NULL, 
	frames INTEGER, 
	error_code VARCHAR(64), 
	error TEXT, 
	warnings TEXT NOT NULL, 
	created DATETIME NOT NULL, 
	started DATETIME, 
	finished DATETIME, 
	PRIMARY KEY (id), 
	CONSTRAINT job_status CHECK (status IN ('queued', 'running', 'done', 'failed', 'cancelled')), 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE
);
INSERT INTO "job" VALUES('00000000000000000000000000000000','cccccccccccccccccccccccccccccccc','127.0.0.1','done',1,50,NULL,NULL,'["a warning"]','2026-01-02 03:04:06.000000','2026-01-02 03:04:07.000000','2026-01-02 03:04:08.000000');
INSERT INTO "job" VALUES('11111111111111111111111111111111','dddddddddddddddddddddddddddddddd','127.0.0.1','failed',1,NULL,'decoder','broken','[]','2026-01-02 03:04:06.000000','2026-01-02 03:04:07.000000','2026-01-02 03:04:08.000000');
CREATE TABLE language (
	id VARCHAR(32) NOT NULL, 
	head INTEGER NOT NULL, 
	sample BOOLEAN NOT NULL, 
	created DATETIME NOT NULL, 
	deleted DATETIME, 
	PRIMARY KEY (id)
);
INSERT INTO "language" VALUES('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',2,0,'2026-01-02 03:05:05.000000',NULL);
CREATE TABLE language_revision (
	language_id VARCHAR(32) NOT NULL, 
	revision INTEGER NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	labels TEXT NOT NULL, 
	change VARCHAR(300) NOT NULL, 
	document TEXT NOT NULL, 
	created DATETIME NOT NULL, author VARCHAR(200) DEFAULT '' NOT NULL, 
	PRIMARY KEY (language_id, revision), 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE
);
INSERT INTO "language_revision" VALUES('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',1,'pool','[]','Created','{
"format": "osg-studio/gesture-language",
"version": 1,
"name": "pool",
"author": "Ada",
"created": "2026-11-29T12:58:50Z",
"revision": 1,
"skeleton": [["left_shoulder","right_shoulder"],["left_shoulder","left_elbow"],["left_elbow","left_wrist"],["right_shoulder","right_elbow"],["right_elbow","right_wrist"],["left_wrist","left_index"],["left_wrist","left_pinky"],["left_wrist","left_thumb"],["right_wrist","right_index"],["right_wrist","right_pinky"],["right_wrist","right_thumb"],["left_shoulder","left_hip"],["right_shoulder","right_hip"],["left_hip","right_hip"],["left_hip","left_knee"],["left_knee","left_ankle"],["right_hip","right_knee"],["right_knee","right_ankle"],["left_ankle","left_foot_index"],["right_ankle","right_foot_index"]],
"settings": {"image_size":224,"image_margin":16,"stroke_width":9,"simplification":4.0,"min_extent":0.1,"max_moments":100,"closing_diameter":28,"hu_floor":0.01,"zernike_degree":8,"fourier_samples":256,"fourier_harmonics":10},
"gestures": [],
"sha256": "06659e1e5b986b5a5880bec0498b64ef84123570b703ccff0e38d029d3d596a2"
}
','2026-01-02 03:05:01.000000','Ada');
INSERT INTO "language_revision" VALUES('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',2,'pool','[]','Renamed','{
"format": "osg-studio/gesture-language",
"version": 1,
"name": "pool",
"author": "Ada",
"created": "2026-11-29T12:58:50Z",
"revision": 2,
"skeleton": [["left_shoulder","right_shoulder"],["left_shoulder","left_elbow"],["left_elbow","left_wrist"],["right_shoulder","right_elbow"],["right_elbow","right_wrist"],["left_wrist","left_index"],["left_wrist","left_pinky"],["left_wrist","left_thumb"],["right_wrist","right_index"],["right_wrist","right_pinky"],["right_wrist","right_thumb"],["left_shoulder","left_hip"],["right_shoulder","right_hip"],["left_hip","right_hip"],["left_hip","left_knee"],["left_knee","left_ankle"],["right_hip","right_knee"],["right_knee","right_ankle"],["left_ankle","left_foot_index"],["right_ankle","right_foot_index"]],
"settings": {"image_size":224,"image_margin":16,"stroke_width":9,"simplification":4.0,"min_extent":0.1,"max_moments":100,"closing_diameter":28,"hu_floor":0.01,"zernike_degree":8,"fourier_samples":256,"fourier_harmonics":10},
"gestures": [],
"sha256": "dde2445471251a7171ad39f81ae4e35c0e402705fa833db1e2254862a9cfee8e"
}
','2026-01-02 03:05:02.000000','Ada');
CREATE TABLE recognition (
	id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	language_id VARCHAR(32) NOT NULL, 
	revision INTEGER NOT NULL, 
	start FLOAT NOT NULL, 
	"end" FLOAT NOT NULL, 
	profile VARCHAR(32) NOT NULL, 
	expected VARCHAR(200), 
	result TEXT NOT NULL, 
	created DATETIME NOT NULL, 
	PRIMARY KEY (id), 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE, 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE
);
INSERT INTO "recognition" VALUES('eeeeeeeeeeeeeeeeeeeeeeeeeeeeeeee','cccccccccccccccccccccccccccccccc','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',1,0.5,1.5,'full','circle','{}','2026-01-02 03:06:05.000000');
CREATE TABLE seeded_sample (
	name VARCHAR(200) NOT NULL, 
	created DATETIME NOT NULL, 
	PRIMARY KEY (name)
);
INSERT INTO "seeded_sample" VALUES('osg-table','2026-01-02 03:04:05.000000');
CREATE INDEX ix_clip_created ON clip (created);
CREATE INDEX ix_language_created ON language (created);
CREATE INDEX ix_job_clip_id ON job (clip_id);
CREATE INDEX ix_job_created ON job (created);
CREATE INDEX ix_job_status ON job (status);
CREATE INDEX ix_recognition_clip_id ON recognition (clip_id);
CREATE INDEX ix_recognition_created ON recognition (created);
CREATE INDEX ix_recognition_language_id ON recognition (language_id);
CREATE INDEX ix_demonstration_source_clip_id ON demonstration_source (clip_id);
COMMIT;
